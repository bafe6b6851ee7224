//! C99: one file that is a header and its source, without allocation, with single calls and batches.

use super::{
    super::{graph::Array, model::Function},
    documentation::{array_name, lines, output_name},
    functions::in_c,
    statements::{Call, Parts, Syntax},
};
use thetahat_model::robot::MathFunction;

/// The beginning of every file. The macros can be predefined.
const PRELUDE: &str = "\
#include <stddef.h>

/* The numbers: double, or float with -DTHETAHAT_REAL=float. */
#ifndef THETAHAT_REAL
#define THETAHAT_REAL double
#endif

/* With -DTHETAHAT_OWN_SINES sines and cosines are computed here, without any library: within two units of the last place of a
 * double up to angles of a million, in a form that compilers put into vectors. Not with -ffast-math. */
#ifdef THETAHAT_OWN_SINES
#ifndef THETAHAT_SINCOS
static inline void thetahat_sincos(const double x, double *const sine, double *const cosine) {
    const double shift = 6755399441055744.0;
    const double quarters = (x * 0.6366197723675814 + shift) - shift;
    const double first = x - quarters * 1.5707963267341256;
    const double second = quarters * 6.077100506303966e-11;
    const double a = first - second;
    const double back = first - a;
    const double lost = (first - (a + back)) + (back - second);
    const double third = quarters * 2.0222662487959508e-21 - lost;
    const double r = a - third;
    const double e = (a - r) - third;
    const double z = r * r;
    const double half = 0.5 * z;
    const double main_part = 1.0 - half;
    const double odd = (((((((1.0 / 355687428096000.0) * z - 1.0 / 1307674368000.0) * z + 1.0 / 6227020800.0) * z
        - 1.0 / 39916800.0) * z + 1.0 / 362880.0) * z - 1.0 / 5040.0) * z + 1.0 / 120.0) * z - 1.0 / 6.0;
    const double even = ((((((1.0 / 20922789888000.0) * z - 1.0 / 87178291200.0) * z + 1.0 / 479001600.0) * z
        - 1.0 / 3628800.0) * z + 1.0 / 40320.0) * z - 1.0 / 720.0) * z + 1.0 / 24.0;
    const double s = r + (r * z * odd + (e - z * e * 0.5));
    const double c = main_part + (((1.0 - main_part) - half) + (z * z * even - r * e));
    /* The quadrant: 0, 1 or -1, and 2 or -2. */
    const double quadrant = quarters - ((quarters * 0.25 + shift) - shift) * 4.0;
    const double even_or_2 = quadrant * quadrant - 1.0;
    const double swapped = even_or_2 * even_or_2;
    const double p = swapped < 0.25 ? c : s;
    const double q = swapped < 0.25 ? s : c;
    *sine = (quadrant - 0.5) * (quadrant - 0.5) < 1.0 ? p : -p;
    *cosine = (quadrant + 0.5) * (quadrant + 0.5) < 1.0 ? q : -q;
}
static inline void thetahat_sincos_real(const double x, THETAHAT_REAL *const sine, THETAHAT_REAL *const cosine) {
    double s, c;
    thetahat_sincos(x, &s, &c);
    *sine = (THETAHAT_REAL)s;
    *cosine = (THETAHAT_REAL)c;
}
static inline THETAHAT_REAL thetahat_sin(const double x) {
    double s, c;
    thetahat_sincos(x, &s, &c);
    return (THETAHAT_REAL)s;
}
static inline THETAHAT_REAL thetahat_cos(const double x) {
    double s, c;
    thetahat_sincos(x, &s, &c);
    return (THETAHAT_REAL)c;
}
#define THETAHAT_SIN(x) thetahat_sin(x)
#define THETAHAT_COS(x) thetahat_cos(x)
#define THETAHAT_SINCOS(x, s, c) thetahat_sincos_real((x), &(s), &(c))
#endif
#endif

/* Otherwise those of the C library, unless both macros are defined before. */
#ifndef THETAHAT_SIN
#include <math.h>
#define THETAHAT_SIN(x) ((THETAHAT_REAL)(sizeof(THETAHAT_REAL) == sizeof(float) ? sinf((float)(x)) : sin(x)))
#define THETAHAT_COS(x) ((THETAHAT_REAL)(sizeof(THETAHAT_REAL) == sizeof(float) ? cosf((float)(x)) : cos(x)))
#endif

/* Sine and cosine of one angle. */
#ifndef THETAHAT_SINCOS
#define THETAHAT_SINCOS(x, s, c) ((s) = THETAHAT_SIN(x), (c) = THETAHAT_COS(x))
#endif

@SIGN@
/* The function of one state belongs into the loop over a batch, which compilers then put into vectors. */
#ifndef THETAHAT_INLINE
#if defined(__GNUC__)
#define THETAHAT_INLINE static inline __attribute__((always_inline))
#elif defined(_MSC_VER)
#define THETAHAT_INLINE static __forceinline
#else
#define THETAHAT_INLINE static inline
#endif
#endif

/* The states of a batch do not depend on each other, whatever the count. */
#ifndef THETAHAT_INDEPENDENT
#if defined(__GNUC__) && !defined(__clang__)
#define THETAHAT_INDEPENDENT _Pragma(\"GCC ivdep\")
#else
#define THETAHAT_INDEPENDENT
#endif
#endif

/* Such as `static`, where the file is included by several others. */
#ifndef THETAHAT_LINKAGE
#define THETAHAT_LINKAGE
#endif
";

/// The macro of the sign of a velocity, or of its smooth form.
fn sign(friction_transition: Option<f64>) -> String {
    match friction_transition {
        None => "\
/* The sign of a velocity: -1, 0 or 1. A smooth one serves simulations, such as tanh((x) / 0.01). */
#ifndef THETAHAT_SIGN
#define THETAHAT_SIGN(x) ((x) > 0 ? (THETAHAT_REAL)1 : (x) < 0 ? (THETAHAT_REAL)-1 : (THETAHAT_REAL)0)
#endif
"
        .to_owned(),
        Some(v) => format!(
            "/* The sign of a velocity, as the model's friction changes it. */\n#ifndef THETAHAT_SIGN\n#include <math.h>\n#define \
             THETAHAT_SIGN(x) ((THETAHAT_REAL)tanh((x) / {v:?}))\n#endif\n"
        ),
    }
}

struct C;

impl Syntax for C {
    fn number(&self, value: f64) -> String {
        format!("(THETAHAT_REAL){value:?}")
    }

    fn input(&self, array: Array, index: usize) -> String {
        match array {
            Array::Parameter => format!("theta[{index}]"),
            Array::Position | Array::Velocity | Array::Acceleration | Array::Torque => {
                format!("{}[{index} * stride]", array_name(array))
            }
        }
    }

    fn constant(&self, place: usize) -> String {
        format!("constants[{place}]")
    }

    fn call(&self, function: Call, argument: &str) -> String {
        let name = match function {
            Call::Sine => "THETAHAT_SIN",
            Call::Cosine => "THETAHAT_COS",
            Call::Sign => "THETAHAT_SIGN",
        };
        format!("{name}({argument})")
    }

    fn function(&self, function: MathFunction, arguments: &[String]) -> String {
        let arguments: Vec<String> = arguments.iter().map(|argument| format!("(double)({argument})")).collect();
        format!("(THETAHAT_REAL){}({})", in_c(function), arguments.join(", "))
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("    const THETAHAT_REAL {name} = {value};")
    }

    fn define_both(&self, [sine, cosine]: [&str; 2], angle: &str) -> Vec<String> {
        vec![format!("    THETAHAT_REAL {sine}, {cosine};"), format!("    THETAHAT_SINCOS({angle}, {sine}, {cosine});")]
    }
}

pub(super) fn code(function: &Function, prefix: &str) -> String {
    let file = File {
        function,
        name: format!("{prefix}_{}", function.model.identifier()),
        parts: Parts::new(&function.program),
    };
    let guard = format!("{}_INCLUDED", file.name.to_uppercase());
    let comment: String =
        lines(function).iter().map(|line| format!(" * {line}").trim_end().to_owned() + "\n").collect();
    let mut text = format!(
        "/*\n{} */\n#ifndef {guard}\n#define {guard}\n\n{PRELUDE}\n",
        comment.replace("*/", "* /").replace("/*", "/ *")
    );
    text = text.replacen("@SIGN@", &sign(function.friction_transition), 1);
    if function.program.calls_functions() {
        text += "#include <math.h>\n\n";
    }
    text += &file.prototypes();
    text += &file.prepare();
    text += &file.state();
    text += &file.calls();
    text + &format!("\n#endif /* {guard} */\n")
}

struct File<'a> {
    function: &'a Function,
    name: String,
    parts: Parts<'a>,
}

impl File<'_> {
    /// Whether constants are computed from parameters.
    fn takes_constants(&self) -> bool {
        !self.parts.constants.is_empty()
    }

    /// The arrays of a state, in order: inputs, constants, output.
    fn arguments(&self) -> Vec<(&'static str, bool)> {
        let inputs = self.function.model.inputs().iter().map(|array| (array_name(*array), true));
        let constants = self.takes_constants().then_some(("constants", true));
        inputs.chain(constants).chain([(output_name(self.function.model), false)]).collect()
    }

    fn declared(&self) -> String {
        let declared = |(name, is_input): (&str, bool)| {
            format!("{}THETAHAT_REAL *restrict {name}", if is_input { "const " } else { "" })
        };
        self.arguments().into_iter().map(declared).collect::<Vec<_>>().join(", ")
    }

    fn single(&self) -> String {
        format!("THETAHAT_LINKAGE void {}({})", self.name, self.declared())
    }

    fn batch(&self) -> String {
        format!("THETAHAT_LINKAGE void {}_batch(size_t count, {})", self.name, self.declared())
    }

    fn prepare_head(&self) -> String {
        let real = "THETAHAT_REAL *restrict";
        format!("THETAHAT_LINKAGE void {}_prepare(const {real} theta, {real} constants)", self.name)
    }

    fn prototypes(&self) -> String {
        let mut text = String::new();
        if self.takes_constants() {
            let count = format!("{}_CONSTANTS", self.name.to_uppercase());
            text += "/* What the parameters decide, once for all states: `constants` has this many entries. */\n";
            text += &format!("#define {count} {}\n{};\n\n", self.parts.constants.len(), self.prepare_head());
        }
        text += &format!("/* One state. No array overlaps the output. */\n{};\n\n", self.single());
        text += "/* `count` states: entry j of state k is at [j * count + k] of its array. */\n";
        text + &format!("{};\n\n", self.batch())
    }

    fn prepare(&self) -> String {
        if !self.takes_constants() {
            return String::new();
        }
        let mut text = format!("{} {{\n", self.prepare_head());
        self.parts.prepare(&C).iter().for_each(|line| text += &format!("{line}\n"));
        for (place, value) in self.parts.prepared(&C).iter().enumerate() {
            text += &format!("    constants[{place}] = {value};\n");
        }
        text + "}\n\n"
    }

    /// The function of one state, whose entries are `stride` apart.
    fn state(&self) -> String {
        let mut text =
            format!("THETAHAT_INLINE void {}_state({}, const size_t stride) {{\n", self.name, self.declared());
        let output = output_name(self.function.model);
        let store = |place: usize, value: &str| format!("    {output}[{place} * stride] = {value};");
        self.parts.run_and_store(&C, store).iter().for_each(|line| text += &format!("{line}\n"));
        for array in self.unused() {
            text += &format!("    (void){array};\n");
        }
        text + "}\n\n"
    }

    /// Unused inputs.
    fn unused(&self) -> impl Iterator<Item = &'static str> {
        let unused = |array: &&Array| self.function.program.length_of(**array) == 0;
        self.function.model.inputs().iter().filter(unused).map(|array| array_name(*array))
    }

    fn calls(&self) -> String {
        let names = |shift: &str| {
            let shifted = |(name, _): (&'static str, bool)| {
                if name == "constants" { name.to_owned() } else { format!("{name}{shift}") }
            };
            self.arguments().into_iter().map(shifted).collect::<Vec<_>>().join(", ")
        };
        let (single, batch, name) = (self.single(), self.batch(), &self.name);
        format!(
            "{single} {{\n    {name}_state({}, 1);\n}}\n\n{batch} {{\n    THETAHAT_INDEPENDENT\n    \
             for (size_t k = 0; k < count; k++) {{\n        {name}_state({}, count);\n    }}\n}}\n",
            names(""),
            names(" + k"),
        )
    }
}
