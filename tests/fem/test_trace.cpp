#include "rbvi/fem/trace.hpp"

#include <gtest/gtest.h>

namespace rbvi::trace_test {
namespace {

// 20 rows; contact dof k sits in row (7 k + 3) mod 20: neither ordered nor contiguous.
constexpr PetscInt rows = 20, contact = 9;
PetscInt row_of(PetscInt k) {
  return (7 * k + 3) % rows;
}

Handle<Mat> layout() {
  Handle<Mat> like;
  RBVI_CALL(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, rows, rows, 1, nullptr, 1,
                         nullptr, like.put()));
  RBVI_CALL(MatSetUp(like.get()));
  return like;
}

Trace make_trace(Mat like) {
  Trace trace{.comm = PETSC_COMM_WORLD, .size = contact, .local_row = {}, .index = {}};
  PetscInt first = 0, last = 0;
  RBVI_CALL(MatGetOwnershipRange(like, &first, &last));
  for (PetscInt k = 0; k < contact; ++k)
    if (row_of(k) >= first && row_of(k) < last) {
      trace.local_row.push_back(row_of(k) - first);
      trace.index.push_back(k);
    }
  return trace;
}

TEST(Trace, restricts_a_vector_on_every_rank) {
  const Handle<Mat> like = layout();
  Handle<Vec> u;
  RBVI_CALL(MatCreateVecs(like.get(), nullptr, u.put()));
  PetscInt first = 0, last = 0;
  RBVI_CALL(VecGetOwnershipRange(u.get(), &first, &last));
  for (PetscInt row = first; row < last; ++row)
    RBVI_CALL(VecSetValue(u.get(), row, 1.5 * row - 4, INSERT_VALUES));
  RBVI_CALL(VecAssemblyBegin(u.get()));
  RBVI_CALL(VecAssemblyEnd(u.get()));
  const Vector values = restrict_to(make_trace(like.get()), u.get());
  ASSERT_EQ(values.size(), contact);
  for (PetscInt k = 0; k < contact; ++k)
    EXPECT_EQ(values(k), 1.5 * row_of(k) - 4);
}

TEST(Trace, extension_is_the_transpose_of_the_restriction) {
  const Handle<Mat> like = layout();
  const Trace trace = make_trace(like.get());
  Matrix values(contact, 4);
  for (Index j = 0; j < 4; ++j)
    for (Index k = 0; k < contact; ++k)
      values(k, j) = static_cast<double>(k) - 2.5 * static_cast<double>(j) + 0.25;
  const Handle<Mat> dense = extension(trace, values, like.get());
  EXPECT_EQ(restrict_to(trace, dense.get()), values);
  double norm = 0;
  RBVI_CALL(MatNorm(dense.get(), NORM_FROBENIUS, &norm));
  EXPECT_NEAR(norm, values.norm(), 1e-14 * values.norm()) << "entries off the contact dofs";
}

TEST(Trace, add_extension_adds) {
  const Handle<Mat> like = layout();
  const Trace trace = make_trace(like.get());
  Handle<Vec> f;
  RBVI_CALL(MatCreateVecs(like.get(), nullptr, f.put()));
  RBVI_CALL(VecSet(f.get(), 2.0));
  const Vector values = Vector::LinSpaced(contact, -1, 7);
  add_extension(trace, values, f.get());
  add_extension(trace, values, f.get());
  EXPECT_EQ(restrict_to(trace, f.get()), Vector(Vector::Constant(contact, 2.0) + 2 * values));
  double sum = 0;
  RBVI_CALL(VecSum(f.get(), &sum));
  EXPECT_NEAR(sum, 2.0 * rows + 2 * values.sum(), 1e-12);
}

TEST(Trace, without_contact_dofs_it_is_empty) {
  const Handle<Mat> like = layout();
  const Trace trace{.comm = PETSC_COMM_WORLD, .size = 0, .local_row = {}, .index = {}};
  Handle<Vec> u;
  RBVI_CALL(MatCreateVecs(like.get(), nullptr, u.put()));
  EXPECT_EQ(restrict_to(trace, u.get()).size(), 0);
}

} // namespace
} // namespace rbvi::trace_test
