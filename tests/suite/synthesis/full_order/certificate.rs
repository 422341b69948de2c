//! A certificate belongs to its gains and to no others.

use super::{CASES, case};
use nalgebra::DMatrix;

#[test]
fn certificate_holds_for_its_own_gains_only() {
    for case in CASES.iter() {
        let (found, name) = (&case.found, case.name());
        let own = found.max_eigenvalue_with(&found.gains).unwrap();
        assert_eq!(own.to_bits(), found.certificate.max_eigenvalue.to_bits());
        assert!(own < 0.0, "{name}: {own:e}");

        let mut other = found.gains.clone();
        other.l.iter_mut().for_each(|row| row[0] *= 0.5);
        let with_other_l = found.max_eigenvalue_with(&other).unwrap();
        assert!(with_other_l > 0.0, "{name}: {with_other_l:e}");

        let mut other = found.gains.clone();
        other.k[0][case.n] *= 1.5;
        let with_other_k = found.max_eigenvalue_with(&other).unwrap();
        assert!(with_other_k > 0.0, "{name}: {with_other_k:e}");
    }
}

#[test]
fn certificate_does_not_hold_at_a_level_below_the_norm() {
    for case in CASES.iter() {
        let mut found = case.found.clone();
        assert!(found.certificate.hinf_norm < found.certificate.rho);
        assert!(found.certificate.meets_design_rho);
        found.certificate.rho = 0.99 * found.certificate.hinf_norm;
        let eigenvalue = found.max_eigenvalue_with(&found.gains).unwrap();
        assert!(eigenvalue > 0.0, "{}: {eigenvalue:e}", case.name());
    }
}

#[test]
fn certificate_is_a_positive_definite_matrix_of_both_halves() {
    for case in CASES.iter() {
        let certificate = &case.found.certificate;
        let size = 2 * case.found.gains.l.len();
        let p = DMatrix::from_fn(size, size, |i, j| certificate.p[i][j]);
        assert_eq!(certificate.p.len(), size);
        // Summed in another order on either side of the diagonal.
        assert!((&p - p.transpose()).amax() < 1e-12 * p.amax());
        assert!(p.cholesky().is_some(), "{}", case.name());
        // A few roundings of the largest term.
        assert!(certificate.residual < 1e-14, "{:e}", certificate.residual);
    }
}

#[test]
fn gains_of_another_shape_are_refused() {
    let found = &case("shared", 2).found;
    let other = &case("kronecker", 2).found.gains;
    let error = found.max_eigenvalue_with(other).err().unwrap();
    assert_eq!(
        error.to_string(),
        "k has 24 values but needs 19: the columns of the gain"
    );
}
