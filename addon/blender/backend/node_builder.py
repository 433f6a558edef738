"""Builds shader nodes that compute arithmetic of sockets and numbers."""


class Nodes:
    """Builds arithmetic nodes in a node tree.

    Inputs are sockets, numbers or tuples of numbers. The nodes stand in columns of six, in the tree's lower half.
    """

    def __init__(self, tree):
        self.tree = tree
        self.count = 0  # nodes made so far

    def new(self, kind):
        """A new node of the Blender type `kind`, at the next position of the layout."""
        node = self.tree.nodes.new(kind)
        column, row = divmod(self.count, 6)
        node.location = (-600.0 + 180.0 * column, -200.0 - 170.0 * row)
        node.hide = kind in ("ShaderNodeMath", "ShaderNodeVectorMath", "ShaderNodeMix")
        self.count += 1
        return node

    def link(self, source, socket):
        """Link `source` to a socket, or set the socket's value to the number or tuple `source`."""
        if isinstance(source, float | int | tuple):
            socket.default_value = source
        else:
            self.tree.links.new(source, socket)

    def feed(self, node, name, source):
        """As `link`, for the input `name` of a node."""
        self.link(source, node.inputs[name])

    def math(self, operation, *inputs):
        """The output of a Math node."""
        node = self.new("ShaderNodeMath")
        node.operation = operation
        for socket, source in zip(node.inputs, inputs, strict=False):
            self.link(source, socket)
        return node.outputs[0]

    def vector(self, operation, *inputs, scale=None):
        """The output of a Vector Math node: a number for "LENGTH", else a vector."""
        node = self.new("ShaderNodeVectorMath")
        node.operation = operation
        for socket, source in zip(node.inputs, inputs, strict=False):
            self.link(source, socket)
        if scale is not None:
            self.feed(node, "Scale", scale)
        return node.outputs["Value" if operation == "LENGTH" else "Vector"]

    def blend(self, factor, low, high):
        """low + factor (high - low), of numbers."""
        return self._mix("FLOAT", factor, low, high)

    def blend_vector(self, factor, low, high):
        """low + factor (high - low), of vectors."""
        return self._mix("VECTOR", factor, low, high)

    def _mix(self, kind, factor, low, high):
        node = self.new("ShaderNodeMix")
        node.data_type = kind
        # A Mix node has sockets for each data type; only those of its own type are enabled.
        enabled = [socket for socket in node.inputs if socket.enabled]
        for socket, source in zip(enabled, (factor, low, high), strict=True):
            self.link(source, socket)
        return next(socket for socket in node.outputs if socket.enabled)

    def split(self, color):
        """The sockets of red, green and blue of a color."""
        node = self.new("ShaderNodeSeparateColor")
        self.link(color, node.inputs[0])
        return node.outputs

    def normal(self, custom):
        """The normal `custom`, or the surface's own where `custom` is zero, as an unlinked socket is."""
        is_custom = self.math("GREATER_THAN", self.vector("LENGTH", custom), 0.0)
        own = self.new("ShaderNodeNewGeometry").outputs["Normal"]
        return self.blend_vector(is_custom, own, custom)

    def principled(self, name, normal, metallic):
        """A Principled BSDF node. `metallic` is 0 or 1, and decides the node's position, too."""
        node = self.new("ShaderNodeBsdfPrincipled")
        node.name = node.label = name
        node.location = (200.0, -300.0 if metallic else -700.0)
        node.inputs["Metallic"].default_value = metallic
        self.feed(node, "Normal", normal)
        return node
