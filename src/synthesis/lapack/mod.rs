//! The BLAS and LAPACK routines that Clarabel's semidefinite cones call, on nalgebra.
//!
//! Clarabel leaves these Fortran symbols open for a numerical library to fill. Exporting them from
//! here makes the program link without one. Conventions are those of the Netlib reference
//! (LAPACK Users' Guide, 3rd ed.): column-major storage with leading dimensions, 32-bit integers,
//! every argument a pointer, no hidden string lengths, flags in either case.
//!
//! What differs from the reference:
//! - An illegal argument of a BLAS routine leaves its outputs as they were; nothing is printed.
//! - No routine needs the caller's workspace, so every workspace query answers 1.
//! - `syevr`, `gesdd` and `gesvd` answer a matrix that is not finite with NaN and `info = 0`.
//! - Those three work in double precision throughout, and `syevr` ignores `abstol`.
#![expect(
    unsafe_code,
    reason = "foreign symbols are called with raw pointers, whose validity the caller vouches for"
)]
#![expect(
    clippy::too_many_arguments,
    reason = "the signatures are those of BLAS and LAPACK"
)]

mod arguments;
mod blas;
mod jacobi;
mod solve;
mod spectral;

use arguments::Outcome;

/// The C type of an argument: everything is passed by address.
macro_rules! pointer {
    (flag, $scalar:ty) => { *const u8 };
    (int, $scalar:ty) => { *const i32 };
    (real, $scalar:ty) => { *const $scalar };
    (input, $scalar:ty) => { *const $scalar };
    (output, $scalar:ty) => { *mut $scalar };
    (int_output, $scalar:ty) => { *mut i32 };
}

/// What the generic routine receives: flags and numbers by value, arrays by address.
macro_rules! argument {
    (flag, $pointer:ident) => {
        *$pointer
    };
    (int, $pointer:ident) => {
        *$pointer
    };
    (real, $pointer:ident) => {
        *$pointer
    };
    ($array:ident, $pointer:ident) => {
        $pointer
    };
}

/// Exports one symbol of a generic routine for one scalar type.
macro_rules! symbol {
    ($scalar:ty, $symbol:ident, $routine:path, $doc:literal, ($($name:ident: $kind:ident),*), $($info:ident)?) => {
        #[doc = $doc]
        ///
        /// # Safety
        /// Every scalar argument must be readable, and every array as large as the reference
        /// documentation of the routine asks for. Outputs must not overlap other arguments.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $symbol($($name: pointer!($kind, $scalar),)* $($info: *mut i32)?) {
            // SAFETY: the caller vouches for its pointers, see above.
            let outcome: Outcome = unsafe { $routine($(argument!($kind, $name)),*) };
            let _ = outcome;
            $(
                // SAFETY: as above.
                unsafe { *$info = outcome.err().unwrap_or(0) };
            )?
        }
    };
}

/// Exports the double and single precision symbols of each routine, and lists them all.
macro_rules! export {
    ($(#[doc = $doc:literal] $routine:path => $double:ident, $single:ident $arguments:tt $($info:ident)?;)*) => {
        $(
            symbol!(f64, $double, $routine, $doc, $arguments, $($info)?);
            symbol!(f32, $single, $routine, $doc, $arguments, $($info)?);
        )*

        /// Keeps the symbols in the program: a linker drops a library nothing of which is used.
        /// To be called where Clarabel is. Costs a few nanoseconds.
        pub fn ensure_linked() {
            std::hint::black_box([$($double as *const (), $single as *const ()),*]);
        }
    };
}

export! {
    #[doc = "`C = alpha op(A) op(B) + beta C`, op(A) m x k and op(B) k x n."]
    blas::gemm => dgemm_, sgemm_ (transa: flag, transb: flag, m: int, n: int, k: int, alpha: real, a: input, lda: int, b: input, ldb: int, beta: real, c: output, ldc: int);
    #[doc = "`y = alpha op(A) x + beta y`, A m x n."]
    blas::gemv => dgemv_, sgemv_ (trans: flag, m: int, n: int, alpha: real, a: input, lda: int, x: input, incx: int, beta: real, y: output, incy: int);
    #[doc = "`y = alpha A x + beta y`, A symmetric n x n, one triangle read."]
    blas::symv => dsymv_, ssymv_ (uplo: flag, n: int, alpha: real, a: input, lda: int, x: input, incx: int, beta: real, y: output, incy: int);
    #[doc = "`C = alpha op(A) op(A)' + beta C`, op(A) n x k, one triangle of C updated."]
    blas::syrk => dsyrk_, ssyrk_ (uplo: flag, trans: flag, n: int, k: int, alpha: real, a: input, lda: int, beta: real, c: output, ldc: int);
    #[doc = "`C = alpha (op(A) op(B)' + op(B) op(A)') + beta C`, one triangle of C updated."]
    blas::syr2k => dsyr2k_, ssyr2k_ (uplo: flag, trans: flag, n: int, k: int, alpha: real, a: input, lda: int, b: input, ldb: int, beta: real, c: output, ldc: int);
    #[doc = "Cholesky factor of one triangle of A, in place; `info` is the order of the first minor that is not positive."]
    solve::potrf => dpotrf_, spotrf_ (uplo: flag, n: int, a: output, lda: int) info;
    #[doc = "Solves `A X = B` in place of B, with the factor that potrf left."]
    solve::potrs => dpotrs_, spotrs_ (uplo: flag, n: int, nrhs: int, a: input, lda: int, b: output, ldb: int) info;
    #[doc = "Solves `A X = B` by LU with partial pivoting, both in place; `info` is the position of the first zero pivot."]
    solve::gesv => dgesv_, sgesv_ (n: int, nrhs: int, a: output, lda: int, ipiv: int_output, b: output, ldb: int) info;
    #[doc = "Eigenvalues (ascending) and eigenvectors of a symmetric matrix, one triangle read."]
    spectral::syevr => dsyevr_, ssyevr_ (jobz: flag, range: flag, uplo: flag, n: int, a: input, lda: int, vl: real, vu: real, il: int, iu: int, abstol: real, m: int_output, w: output, z: output, ldz: int, isuppz: int_output, work: output, lwork: int, iwork: int_output, liwork: int) info;
    #[doc = "Singular values (descending) and vectors; one job for both sides."]
    spectral::gesdd => dgesdd_, sgesdd_ (jobz: flag, m: int, n: int, a: output, lda: int, s: output, u: output, ldu: int, vt: output, ldvt: int, work: output, lwork: int, iwork: int_output) info;
    #[doc = "Singular values (descending) and vectors; one job for each side."]
    spectral::gesvd => dgesvd_, sgesvd_ (jobu: flag, jobvt: flag, m: int, n: int, a: output, lda: int, s: output, u: output, ldu: int, vt: output, ldvt: int, work: output, lwork: int) info;
}
