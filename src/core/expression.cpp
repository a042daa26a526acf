#include "rbvi/core/expression.hpp"

#include "expression_operations.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace rbvi {

namespace {

constexpr int stack_size = 64;

} // namespace

int operands_of(Operation operation) {
  return operation < Operation::negate ? 0
         : operation < Operation::add  ? 1
                                       : 2 + (operation == Operation::choose);
}

Expression::Expression(Program program, const std::vector<std::string> &names)
    : program_(std::move(program)) {
  std::map<std::string, int> used;
  int depth = 0;
  for (const Instruction &step : program_) {
    if (step.operation == Operation::name) used[names[step.name]];
    depth += 1 - operands_of(step.operation);
    if (depth > stack_size)
      throw bad_input("an expression has to keep more than " + std::to_string(stack_size) +
                      " numbers at once: write operands that are long first");
  }
  for (auto &[name, place] : used) {
    place = static_cast<int>(names_.size());
    names_.push_back(name);
  }
  for (Instruction &step : program_)
    if (step.operation == Operation::name) step.name = used[names[step.name]];
}

std::optional<double> Expression::constant() const {
  if (!names_.empty()) return std::nullopt;
  return bound_to(*this, {}).value(nullptr);
}

BoundExpression bound_to(const Expression &expression, const std::vector<std::string> &names,
                         const std::vector<std::string> &by) {
  return BoundExpression(bound_program({}, {expression}, {}, names, by));
}

BoundExpression bound_to(const Expression &expression, const std::vector<std::string> &names) {
  return bound_to(expression, names, names);
}

} // namespace rbvi
