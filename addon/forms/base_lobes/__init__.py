"""Base lobes: closures that a shader hands to Cycles, which together are nearly the target, and their fit."""
