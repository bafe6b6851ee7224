//! Xacro, the macro language in which URDF is written, expanded without an installation of ROS.
//!
//! Read are properties (value, default, block, scope, remove), `${expressions}` of Python (arithmetic, comparisons, `and or
//! not`, `a if b else c`, texts, lists, dictionaries, indices and slices, the functions of `math` and the common built-in
//! ones), `$(arg)`, `$(find)`, `$(dirname)` and `$(optenv)` with a default, macros with parameters, defaults and blocks,
//! `include` with `ns` and `optional`, `if` and `unless`, `insert_block`, `element`, `attribute`, `call` and `load_yaml`. The
//! environment is not read. An expansion reads the file's own package (without one: its folder and the one above), packages
//! named by [`XacroOptions`], and packages with a `package.xml` in or next to the folders above the file.

mod definitions;
mod elements;
mod error;
mod evaluation;
mod expansion;
mod expression_error;
mod folders;
mod formats;
mod functions;
mod macros;
mod methods;
mod operands;
mod operators;
mod options;
mod parser;
mod scope;
mod state;
mod substitution;
mod syntax;
mod tokens;
mod tree;
mod value;
mod value_functions;
mod words_reader;
mod yaml;
mod yaml_scalars;

pub use error::{XacroError, XacroProblem};
pub use expansion::{ExpandedXacro, expand_xacro};
pub use expression_error::ExpressionError;
pub use options::XacroOptions;

#[cfg(test)]
mod reference_cases;
#[cfg(test)]
mod tests;
