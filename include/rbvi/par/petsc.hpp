// One throwing macro around PETSc and SLEPc calls, one move-only owner of their handles.
#pragma once

#include <petsc.h>
#include <slepc.h>

#include <utility>

namespace rbvi {

/// Throws failure with the name of the function called and PETSc's own innermost message, in one
/// line (see ErrorRecorder).
[[noreturn]] void throw_petsc_error(PetscErrorCode code, const char *call);

} // namespace rbvi

/// Calls PETSc or SLEPc; throws rbvi::Error when the call fails.
#define RBVI_CALL(...)                                                                             \
  do {                                                                                             \
    const PetscErrorCode rbvi_code_ = (__VA_ARGS__);                                               \
    if (rbvi_code_ != 0) ::rbvi::throw_petsc_error(rbvi_code_, #__VA_ARGS__);                      \
  } while (false)

namespace rbvi {

namespace detail {
inline PetscErrorCode destroy(Vec *x) {
  return VecDestroy(x);
}
inline PetscErrorCode destroy(Mat *x) {
  return MatDestroy(x);
}
inline PetscErrorCode destroy(KSP *x) {
  return KSPDestroy(x);
}
inline PetscErrorCode destroy(SNES *x) {
  return SNESDestroy(x);
}
inline PetscErrorCode destroy(DM *x) {
  return DMDestroy(x);
}
inline PetscErrorCode destroy(IS *x) {
  return ISDestroy(x);
}
inline PetscErrorCode destroy(VecScatter *x) {
  return VecScatterDestroy(x);
}
inline PetscErrorCode destroy(PetscSection *x) {
  return PetscSectionDestroy(x);
}
inline PetscErrorCode destroy(PetscViewer *x) {
  return PetscViewerDestroy(x);
}
inline PetscErrorCode destroy(BV *x) {
  return BVDestroy(x);
}
inline PetscErrorCode destroy(EPS *x) {
  return EPSDestroy(x);
}
inline PetscErrorCode destroy(SVD *x) {
  return SVDDestroy(x);
}
} // namespace detail

/// Owns one reference to a PETSc or SLEPc object; move-only. `get()` hands out the raw handle.
template <class T> class Handle {
public:
  Handle() = default;
  explicit Handle(T raw) noexcept : raw_(raw) {}
  Handle(Handle &&other) noexcept : raw_(std::exchange(other.raw_, nullptr)) {}
  Handle &operator=(Handle &&other) noexcept {
    Handle taken(std::move(other));
    std::swap(raw_, taken.raw_);
    return *this;
  }
  ~Handle() {
    if (raw_ != nullptr) (void)detail::destroy(&raw_);
  }
  Handle(const Handle &) = delete;
  Handle &operator=(const Handle &) = delete;

  T get() const noexcept { return raw_; }
  /// For PETSc's creation calls: releases what is held, then hands out the address.
  T *put() {
    if (raw_ != nullptr) RBVI_CALL(detail::destroy(&raw_));
    raw_ = nullptr;
    return &raw_;
  }
  explicit operator bool() const noexcept { return raw_ != nullptr; }

private:
  T raw_ = nullptr;
};

/// Another owner of the same object (PETSc counts references).
template <class T> Handle<T> share(const Handle<T> &handle) {
  RBVI_CALL(PetscObjectReference(reinterpret_cast<PetscObject>(handle.get())));
  return Handle<T>(handle.get());
}

} // namespace rbvi
