#include "rbvi/core/error.hpp"
#include "rbvi/par/session.hpp"

#include <gtest/gtest.h>
#include <petscksp.h>

#include <string>

namespace rbvi::petsc_test {
namespace {

Handle<Vec> make_vector() {
  Handle<Vec> x;
  RBVI_CALL(VecCreateSeq(PETSC_COMM_SELF, 3, x.put()));
  return x;
}

PetscInt references(Vec x) {
  PetscInt count = 0;
  RBVI_CALL(PetscObjectGetReference(reinterpret_cast<PetscObject>(x), &count));
  return count;
}

TEST(Handle, move_construction_hands_over) {
  Handle<Vec> first = make_vector();
  const Vec raw = first.get();
  const Handle<Vec> second(std::move(first));
  EXPECT_EQ(second.get(), raw);
  EXPECT_FALSE(first);
  EXPECT_EQ(references(raw), 1);
}

TEST(Handle, move_assignment_releases_the_old_object_at_once) {
  Handle<Vec> first = make_vector(), second = make_vector();
  const Handle<Vec> witness = share(first);
  const Vec raw = second.get();
  ASSERT_EQ(references(witness.get()), 2);
  first = std::move(second);
  EXPECT_EQ(first.get(), raw);
  EXPECT_FALSE(second);
  EXPECT_EQ(references(witness.get()), 1);
  EXPECT_EQ(references(raw), 1);
}

TEST(Handle, self_move_keeps_the_object) {
  Handle<Vec> x = make_vector();
  const Vec raw = x.get();
  Handle<Vec> &alias = x;
  x = std::move(alias);
  EXPECT_EQ(x.get(), raw);
  EXPECT_EQ(references(raw), 1);
}

TEST(Handle, put_releases_what_is_held) {
  Handle<Vec> x = make_vector();
  const Handle<Vec> witness = share(x);
  RBVI_CALL(VecCreateSeq(PETSC_COMM_SELF, 2, x.put()));
  EXPECT_EQ(references(witness.get()), 1);
  EXPECT_NE(x.get(), witness.get());
}

TEST(Handle, destruction_releases) {
  const Handle<Vec> witness = make_vector();
  {
    const Handle<Vec> other = share(witness);
    EXPECT_EQ(references(witness.get()), 2);
  }
  EXPECT_EQ(references(witness.get()), 1);
}

std::string message_of(PetscErrorCode (*call)()) {
  try {
    RBVI_CALL(call());
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::failed);
    return error.what();
  }
  return "nothing thrown";
}

TEST(Error, carries_the_message_of_petsc_in_one_line) {
  const ErrorRecorder recorder;
  testing::internal::CaptureStderr();
  const std::string message = message_of([]() -> PetscErrorCode {
    Vec x = nullptr;
    PetscCall(VecCreate(PETSC_COMM_SELF, &x));
    const PetscErrorCode code = VecSetType(x, "no_such_type");
    PetscCall(VecDestroy(&x));
    PetscCall(code);
    return 0;
  });
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_NE(message.find("no_such_type"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_EQ(message.rfind("call: ", 0), 0U) << message;
}

TEST(Error, newlines_of_a_message_become_blanks_and_the_innermost_wins) {
  const ErrorRecorder recorder;
  const std::string message = message_of([]() -> PetscErrorCode {
    const auto inner = []() -> PetscErrorCode {
      SETERRQ(PETSC_COMM_SELF, PETSC_ERR_USER, "gap is\n  negative");
    };
    PetscCall(inner());
    return 0;
  });
  EXPECT_EQ(message, "call: gap is negative (PETSc error " + std::to_string(PETSC_ERR_USER) + ")");
}

TEST(Error, a_bare_code_does_not_inherit_an_earlier_message) {
  const ErrorRecorder recorder;
  (void)message_of(
      []() -> PetscErrorCode { SETERRQ(PETSC_COMM_SELF, PETSC_ERR_USER, "earlier trouble"); });
  const std::string message = message_of([]() -> PetscErrorCode { return PETSC_ERR_MEM; });
  EXPECT_EQ(message.find("earlier"), std::string::npos) << message;
  EXPECT_NE(message.find("memory"), std::string::npos) << message;
}

TEST(Error, a_singular_stiffness_is_told_in_words_of_the_body) {
  const ErrorRecorder recorder;
  const std::string message = message_of([]() -> PetscErrorCode {
    Mat matrix = nullptr;
    PC pc = nullptr;
    const PetscInt rows[] = {0, 1};
    const PetscScalar values[] = {1, -1, -1, 1}; // a spring between two free points
    PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, 2, 2, 2, nullptr, &matrix));
    PetscCall(MatSetValues(matrix, 2, rows, 2, rows, values, INSERT_VALUES));
    PetscCall(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
    PetscCall(PCCreate(PETSC_COMM_SELF, &pc));
    PetscCall(PCSetType(pc, PCCHOLESKY));
    PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERCHOLMOD));
    PetscCall(PCSetOperators(pc, matrix, matrix));
    const PetscErrorCode code = PCSetUp(pc);
    PetscCall(PCDestroy(&pc));
    PetscCall(MatDestroy(&matrix));
    PetscCall(code);
    return 0;
  });
  EXPECT_TRUE(message.starts_with("a matrix is singular: is there a body that no fixed boundary"))
      << message;
}

} // namespace
} // namespace rbvi::petsc_test
