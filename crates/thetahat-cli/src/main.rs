//! The thetahat command line.

fn main() {}
