//! Names of functions beside sine and cosine.

use crate::robot::MathFunction;

/// The name in C, whose functions are those of `math.h`.
pub(super) fn in_c(function: MathFunction) -> &'static str {
    use MathFunction as F;
    match function {
        F::Exponential => "exp",
        F::Logarithm => "log",
        F::SquareRoot => "sqrt",
        F::CubeRoot => "cbrt",
        F::Tangent => "tan",
        F::ArcSine => "asin",
        F::ArcCosine => "acos",
        F::ArcTangent => "atan",
        F::HyperbolicSine => "sinh",
        F::HyperbolicCosine => "cosh",
        F::HyperbolicTangent => "tanh",
        F::AreaSine => "asinh",
        F::AreaCosine => "acosh",
        F::AreaTangent => "atanh",
        F::Floor => "floor",
        F::Power => "pow",
        F::ArcTangentOfPoint => "atan2",
        F::Smaller => "fmin",
        F::Larger => "fmax",
    }
}

/// The name of the method of Rust's floating-point numbers.
pub(super) fn in_rust(function: MathFunction) -> &'static str {
    match function {
        MathFunction::Logarithm => "ln",
        MathFunction::Power => "powf",
        MathFunction::Smaller => "min",
        MathFunction::Larger => "max",
        other @ (MathFunction::Exponential
        | MathFunction::SquareRoot
        | MathFunction::CubeRoot
        | MathFunction::Tangent
        | MathFunction::ArcSine
        | MathFunction::ArcCosine
        | MathFunction::ArcTangent
        | MathFunction::HyperbolicSine
        | MathFunction::HyperbolicCosine
        | MathFunction::HyperbolicTangent
        | MathFunction::AreaSine
        | MathFunction::AreaCosine
        | MathFunction::AreaTangent
        | MathFunction::Floor
        | MathFunction::ArcTangentOfPoint) => in_c(other),
    }
}

/// The name in NumPy.
pub(super) fn in_numpy(function: MathFunction) -> &'static str {
    match function {
        MathFunction::ArcSine => "arcsin",
        MathFunction::ArcCosine => "arccos",
        MathFunction::ArcTangent => "arctan",
        MathFunction::AreaSine => "arcsinh",
        MathFunction::AreaCosine => "arccosh",
        MathFunction::AreaTangent => "arctanh",
        MathFunction::Power => "power",
        MathFunction::ArcTangentOfPoint => "arctan2",
        MathFunction::Smaller => "minimum",
        MathFunction::Larger => "maximum",
        other @ (MathFunction::Exponential
        | MathFunction::Logarithm
        | MathFunction::SquareRoot
        | MathFunction::CubeRoot
        | MathFunction::Tangent
        | MathFunction::HyperbolicSine
        | MathFunction::HyperbolicCosine
        | MathFunction::HyperbolicTangent
        | MathFunction::Floor) => in_c(other),
    }
}

/// The call in MATLAB, element by element.
pub(super) fn in_matlab(function: MathFunction, arguments: &[String]) -> String {
    let name = match function {
        MathFunction::CubeRoot => return format!("nthroot({}, 3)", arguments.join(", ")),
        MathFunction::Power => "power",
        MathFunction::Smaller => "min",
        MathFunction::Larger => "max",
        other @ (MathFunction::Exponential
        | MathFunction::Logarithm
        | MathFunction::SquareRoot
        | MathFunction::Tangent
        | MathFunction::ArcSine
        | MathFunction::ArcCosine
        | MathFunction::ArcTangent
        | MathFunction::HyperbolicSine
        | MathFunction::HyperbolicCosine
        | MathFunction::HyperbolicTangent
        | MathFunction::AreaSine
        | MathFunction::AreaCosine
        | MathFunction::AreaTangent
        | MathFunction::Floor
        | MathFunction::ArcTangentOfPoint) => in_c(other),
    };
    format!("{name}({})", arguments.join(", "))
}

/// The operator in LaTeX.
pub(super) fn in_latex(function: MathFunction) -> &'static str {
    use MathFunction as F;
    match function {
        F::Exponential => "\\exp",
        F::Logarithm => "\\ln",
        F::SquareRoot => "\\sqrt",
        F::CubeRoot => "\\operatorname{cbrt}",
        F::Tangent => "\\tan",
        F::ArcSine => "\\arcsin",
        F::ArcCosine => "\\arccos",
        F::ArcTangent => "\\arctan",
        F::HyperbolicSine => "\\sinh",
        F::HyperbolicCosine => "\\cosh",
        F::HyperbolicTangent => "\\tanh",
        F::AreaSine => "\\operatorname{arsinh}",
        F::AreaCosine => "\\operatorname{arcosh}",
        F::AreaTangent => "\\operatorname{artanh}",
        F::Floor => "\\operatorname{floor}",
        F::Power => "\\operatorname{pow}",
        F::ArcTangentOfPoint => "\\operatorname{atan2}",
        F::Smaller => "\\min",
        F::Larger => "\\max",
    }
}
