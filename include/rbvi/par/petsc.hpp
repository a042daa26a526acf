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
    if (raw_ != nullptr) (void)PetscObjectDestroy(object());
  }
  Handle(const Handle &) = delete;
  Handle &operator=(const Handle &) = delete;

  T get() const noexcept { return raw_; }
  /// For PETSc's creation calls: releases what is held, then hands out the address.
  T *put() {
    if (raw_ != nullptr) RBVI_CALL(PetscObjectDestroy(object()));
    raw_ = nullptr;
    return &raw_;
  }
  explicit operator bool() const noexcept { return raw_ != nullptr; }

private:
  PetscObject *object() noexcept { return reinterpret_cast<PetscObject *>(&raw_); }
  T raw_ = nullptr;
};

/// Another owner of the same object (PETSc counts references).
template <class T> Handle<T> share(const Handle<T> &handle) {
  RBVI_CALL(PetscObjectReference(reinterpret_cast<PetscObject>(handle.get())));
  return Handle<T>(handle.get());
}

/// Calls visitor(row, column, value) for each local entry. Not collective.
template <class Visitor> void visit_entries(Mat a, Visitor &&visitor) {
  PetscInt begin = 0, end = 0;
  RBVI_CALL(MatGetOwnershipRange(a, &begin, &end));
  for (PetscInt row = begin; row < end; ++row) {
    PetscInt count = 0;
    const PetscInt *columns = nullptr;
    const PetscScalar *values = nullptr;
    RBVI_CALL(MatGetRow(a, row, &count, &columns, &values));
    for (PetscInt k = 0; k < count; ++k)
      visitor(row, columns[k], values[k]);
    RBVI_CALL(MatRestoreRow(a, row, &count, &columns, &values));
  }
}

} // namespace rbvi
