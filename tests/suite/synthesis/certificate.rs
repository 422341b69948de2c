//! A certificate belongs to its gains and to no others.

use super::*;

#[test]
fn certificate_read_back_holds_for_its_own_gains_only() {
    for case in CASES.iter() {
        let ChannelSynthesis {
            certificate,
            ftc,
            design,
            ..
        } = &case.synthesis;
        let own = certificate.max_eigenvalue_with(design, ftc).unwrap();
        assert_eq!(own.to_bits(), certificate.max_eigenvalue.to_bits());

        let mut tampered = ftc.clone();
        tampered.l.iter_mut().for_each(|row| row[2] *= 0.5);
        let with_tampered_l = certificate.max_eigenvalue_with(design, &tampered).unwrap();
        assert!(with_tampered_l > 0.0, "{}: {with_tampered_l:e}", case.name);

        let mut tampered = ftc.clone();
        tampered.k[1] *= 1.5;
        let with_tampered_k = certificate.max_eigenvalue_with(design, &tampered).unwrap();
        assert!(with_tampered_k > 0.0, "{}: {with_tampered_k:e}", case.name);
    }
}

#[test]
fn certificate_does_not_hold_at_a_level_below_the_norm() {
    let case = uav();
    let mut certificate = case.synthesis.certificate.clone();
    certificate.rho = 0.99 * certificate.hinf_norm;
    let eigenvalue = certificate
        .max_eigenvalue_with(&case.design, &case.synthesis.ftc)
        .unwrap();
    assert!(eigenvalue > 0.0);
}

#[test]
fn verification_repeats_what_synthesis_found() {
    for case in CASES.iter() {
        let verified = verify(&case.design, &case.synthesis.ftc).unwrap();
        assert_eq!(
            verified.certificate.as_ref(),
            Some(&case.synthesis.certificate)
        );
        assert_eq!(verified.analysis, case.synthesis.analysis.ftc);
        let pid = verify(&case.design, &case.synthesis.pid).unwrap();
        assert_eq!(pid.certificate, None);
    }
}
