//! Names of functions other than sine and cosine.

use thetahat_model::robot::MathFunction;

/// The names of a function.
struct Names {
    c: &'static str,
    rust: &'static str,
    numpy: &'static str,
    matlab: &'static str,
    latex: &'static str,
}

impl Names {
    fn of(function: MathFunction) -> Self {
        use MathFunction as F;
        let [c, rust, numpy, matlab, latex] = match function {
            F::Exponential => ["exp", "exp", "exp", "exp", "\\exp"],
            F::Logarithm => ["log", "ln", "log", "log", "\\ln"],
            F::SquareRoot => ["sqrt", "sqrt", "sqrt", "sqrt", "\\sqrt"],
            F::CubeRoot => ["cbrt", "cbrt", "cbrt", "nthroot", "\\operatorname{cbrt}"],
            F::Tangent => ["tan", "tan", "tan", "tan", "\\tan"],
            F::ArcSine => ["asin", "asin", "arcsin", "asin", "\\arcsin"],
            F::ArcCosine => ["acos", "acos", "arccos", "acos", "\\arccos"],
            F::ArcTangent => ["atan", "atan", "arctan", "atan", "\\arctan"],
            F::HyperbolicSine => ["sinh", "sinh", "sinh", "sinh", "\\sinh"],
            F::HyperbolicCosine => ["cosh", "cosh", "cosh", "cosh", "\\cosh"],
            F::HyperbolicTangent => ["tanh", "tanh", "tanh", "tanh", "\\tanh"],
            F::AreaSine => ["asinh", "asinh", "arcsinh", "asinh", "\\operatorname{arsinh}"],
            F::AreaCosine => ["acosh", "acosh", "arccosh", "acosh", "\\operatorname{arcosh}"],
            F::AreaTangent => ["atanh", "atanh", "arctanh", "atanh", "\\operatorname{artanh}"],
            F::Floor => ["floor", "floor", "floor", "floor", "\\operatorname{floor}"],
            F::Power => ["pow", "powf", "power", "power", "\\operatorname{pow}"],
            F::ArcTangentOfPoint => ["atan2", "atan2", "arctan2", "atan2", "\\operatorname{atan2}"],
            F::Smaller => ["fmin", "min", "minimum", "min", "\\min"],
            F::Larger => ["fmax", "max", "maximum", "max", "\\max"],
        };
        Self { c, rust, numpy, matlab, latex }
    }
}

/// The name in C, whose functions are those of `math.h`.
pub(super) fn in_c(function: MathFunction) -> &'static str {
    Names::of(function).c
}

/// The name of the method of Rust's floating-point numbers.
pub(super) fn in_rust(function: MathFunction) -> &'static str {
    Names::of(function).rust
}

/// The name in NumPy.
pub(super) fn in_numpy(function: MathFunction) -> &'static str {
    Names::of(function).numpy
}

/// The call in MATLAB, element by element.
pub(super) fn in_matlab(function: MathFunction, arguments: &[String]) -> String {
    let degree = if function == MathFunction::CubeRoot { ", 3" } else { "" };
    format!("{}({}{degree})", Names::of(function).matlab, arguments.join(", "))
}

/// The operator in LaTeX.
pub(super) fn in_latex(function: MathFunction) -> &'static str {
    Names::of(function).latex
}
