#include "rbvi/core/expression.hpp"

#include <map>

namespace rbvi {

int operands_of(Operation operation) {
  return operation < Operation::negate ? 0
         : operation < Operation::add  ? 1
                                       : 2 + (operation == Operation::choose);
}

Expression::Expression(Program program, const std::vector<std::string> &names)
    : program_(std::move(program)) {
  std::map<std::string, int> used;
  for (const Instruction &step : program_)
    if (step.operation == Operation::name) used[names[step.name]];
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
