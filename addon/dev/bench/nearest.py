"""What a model is measured beside: the closure of Cycles that comes nearest, and its own base alone."""
from ...backends.nodes.appearance import appearance
from ...backends.osl import assembler, estimator
from ...measure import specimen, standards
from .efficiency import Candidate


def natives(model, values) -> list:
    """Candidates of Cycles' own: the closure in OSL, and a Glossy node in SVM, which is what everyone renders.

    They have the model's exponent where Cycles has the lobe, and else are as wide at normal incidence. Cycles has no
    node for phong_ramp: Beckmann's microfacets stand beside it.
    """
    exponent = appearance(model, values)[1]
    alpha = min(float(2.0 / (exponent + 2.0)) ** 0.5, 1.0)
    if estimator.base_family(model) == "phong":
        closure, distribution = standards.phong(values["exponent"]), "BECKMANN"
    elif estimator.base_family(model) == "blinn":
        closure, distribution = standards.ashikhmin_shirley(values["exponent"]), "ASHIKHMIN_SHIRLEY"
    else:
        closure, distribution = standards.microfacet("beckmann", alpha), "BECKMANN"
    return [Candidate(f"{closure.id.replace('phong', 'phong_ramp')} (OSL)", closure.material()),
            Candidate(f"{distribution.lower()} (SVM)", standards.native(distribution, alpha**0.5), osl=False)]


def ours(model, assignments, samples) -> Candidate:
    """A model with `assignments` (texts, see `subject.settings`) and a number of samples per hit."""
    chosen = [a for a in assignments if not a.startswith("samples")] + [f"samples={samples}"]
    return Candidate(f"{model.id}, {samples}", specimen.of_model(model.id, chosen).material)


def base_alone(model, assignments) -> Candidate:
    """The base of a model without kernels: less noise, and quicker, than any estimator with this base can be."""
    made = specimen.of_model(model.id, assignments)
    text = assembler.assemble(model, parameters=made.parameters, defines={"KERNELS": "0"})
    from ...blender.backend import osl
    from ...blender.material import groups

    node = groups.find_node(made.material)
    groups.own(node)  # other materials of the model use the same
    osl.fill(osl.script_of(node), osl.compile_text(model, text))
    return Candidate(f"{model.id}, base alone", made.material)
