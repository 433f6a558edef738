"""Makes shader nodes of arithmetic out of sockets and numbers."""


class Nodes:
    """Makes nodes of arithmetic, whose inputs are sockets or numbers, one below another in the group's lower half."""

    def __init__(self, tree):
        self.tree, self.count = tree, 0

    def new(self, kind):
        node = self.tree.nodes.new(kind)
        column, row = divmod(self.count, 6)
        node.location = (-600.0 + 180.0 * column, -200.0 - 170.0 * row)
        node.hide = kind in ("ShaderNodeMath", "ShaderNodeVectorMath", "ShaderNodeMix")
        self.count += 1
        return node

    def link(self, source, socket):
        """Feed a socket from another, or set it to a number."""
        if isinstance(source, float | int | tuple):
            socket.default_value = source
        else:
            self.tree.links.new(source, socket)

    def feed(self, node, name, source):
        self.link(source, node.inputs[name])

    def math(self, operation, *inputs):
        node = self.new("ShaderNodeMath")
        node.operation = operation
        for socket, source in zip(node.inputs, inputs, strict=False):
            self.link(source, socket)
        return node.outputs[0]

    def vector(self, operation, *inputs, scale=None):
        node = self.new("ShaderNodeVectorMath")
        node.operation = operation
        for socket, source in zip(node.inputs, inputs, strict=False):
            self.link(source, socket)
        if scale is not None:
            self.feed(node, "Scale", scale)
        return node.outputs["Value" if operation == "LENGTH" else "Vector"]

    def blend(self, factor, low, high):
        """low + factor (high - low)."""
        return self._mix("FLOAT", factor, low, high)

    def blend_vector(self, factor, low, high):
        return self._mix("VECTOR", factor, low, high)

    def _mix(self, kind, factor, low, high):
        node = self.new("ShaderNodeMix")
        node.data_type = kind
        # A Mix node has the sockets of all its types; those of one type are enabled.
        used = [socket for socket in node.inputs if socket.enabled]
        for socket, source in zip(used, (factor, low, high), strict=True):
            self.link(source, socket)
        return next(socket for socket in node.outputs if socket.enabled)

    def split(self, colour):
        node = self.new("ShaderNodeSeparateColor")
        self.link(colour, node.inputs[0])
        return node.outputs

    def normal(self, given):
        """The surface's own normal where the one given is zero, as it is when nothing is plugged in."""
        is_given = self.math("GREATER_THAN", self.vector("LENGTH", given), 0.0)
        own = self.new("ShaderNodeNewGeometry").outputs["Normal"]
        return self.blend_vector(is_given, own, given)

    def principled(self, name, normal, metallic):
        node = self.new("ShaderNodeBsdfPrincipled")
        node.name = node.label = name
        node.location = (200.0, -300.0 if metallic else -700.0)
        node.inputs["Metallic"].default_value = metallic
        self.feed(node, "Normal", normal)
        return node
