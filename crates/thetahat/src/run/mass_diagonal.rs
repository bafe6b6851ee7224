use thetahat_model::dynamics::{DynamicParameters, Model, Workspace};

/// The diagonal of the mass matrix of standard parameters at a position; none for parameters that the model does not have.
pub(super) fn mass_diagonal(model: &Model, standard: &[f64], q: &[f64]) -> Option<Vec<f64>> {
    let parameters = DynamicParameters::new(model, standard).ok()?;
    let count = model.coordinate_count();
    let mut mass = vec![0.0; count * count];
    model.mass_matrix(&parameters, q, &mut Workspace::new(model), &mut mass);
    Some((0..count).map(|j| mass[j * count + j]).collect())
}
