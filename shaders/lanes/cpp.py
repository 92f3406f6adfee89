"""What GLSL's types and built-in functions are in the C++ of server/render/native/programs/glsl.hpp."""
from .parse import Type

FLOAT, INT, UINT, BOOL, VOID = Type("float"), Type("int"), Type("uint"), Type("bool"), Type("void")
LANE = {"float": "vfloat", "int": "vint", "uint": "vuint", "bool": "vbool", "double": "vdouble"}
PLAIN = {"float": "float", "int": "int32_t", "uint": "uint32_t", "bool": "bool", "double": "double"}

# Built-in functions by their result: "same" as the widest argument, "scalar" of its base, or a type.
BUILTINS = {
    **{name: "same" for name in (
        "abs sign floor ceil round fract min max clamp mix step smoothstep sqrt inversesqrt pow exp2 log2 cross "
        "normalize ldexp transpose").split()},
    **{name: "scalar" for name in "dot length distance".split()},
    **{name: "bools" for name in ("lessThan lessThanEqual greaterThan greaterThanEqual").split()},
    "any": BOOL, "all": BOOL, "bitCount": INT, "findLSB": INT, "floatBitsToUint": "uints",
    "uintBitsToFloat": "floats", "packDouble2x32": Type("double"),
}
MEMORY = ("texelFetch", "textureLod", "textureSize", "imageLoad", "imageStore", "atomicAdd", "atomicMax", "barrier",
          "frexp", "makeTexels")
# What an image or a texture holds.
TEXEL = {"image2D": Type("float", 4), "uimage2D": Type("uint", 4), "sampler2D": Type("float", 4),
         "usampler2D": Type("uint", 4), "samplerBuffer": Type("float", 4), "usamplerBuffer": Type("uint", 4)}


def cpp_type(of, varying):
    """`of` with lanes where it varies; structs always hold lanes."""
    if of.size is not None:
        return "array<%s, %s>" % (cpp_type(of.element(), varying), of.size)
    if not of.is_number:
        return of.base
    scalar = (LANE if varying else PLAIN)[of.base]
    if of.columns:
        return "mat%d<%s>" % (of.rows, scalar)
    return scalar if of.rows == 1 else "vec%d<%s>" % (of.rows, scalar)


def always_varies(of):
    """Structs and arrays of variables are not inferred."""
    return of.size is not None or not of.is_number
