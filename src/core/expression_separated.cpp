#include "rbvi/core/expression.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr std::size_t most_terms = 64;

struct SplitTerm {
  Program f, g;
};
using SplitTerms = std::vector<SplitTerm>;

/// What has names of one group alone is one term, f 1 or 1 g.
struct SplitPart {
  bool first = false, second = false; ///< of which groups it has names
  SplitTerms terms;
  bool mixed() const { return first && second; }
  const Program &factor() const { return second ? terms[0].g : terms[0].f; }
};

const Program one_program{{Operation::number, 0, 1}}, zero_program{{Operation::number, 0, 0}};

Program applied(Operation operation, std::vector<Program> operands) {
  const bool product = operation == Operation::multiply;
  if (product && operands[0] == one_program) return operands[1];
  if ((product || operation == Operation::divide) && operands[1] == one_program) return operands[0];
  Program all;
  for (const Program &operand : operands)
    all.insert(all.end(), operand.begin(), operand.end());
  all.push_back({operation});
  return all;
}

/// Adds them to a sum, or subtracts them.
void add_terms(Operation operation, SplitTerms &sum, const SplitTerms &more) {
  for (const SplitTerm &term : more) {
    const auto like = std::find_if(sum.begin(), sum.end(), [&](const SplitTerm &one) {
      return one.f == term.f || one.g == term.g;
    });
    if (like == sum.end())
      sum.push_back(operation == Operation::add
                        ? term
                        : SplitTerm{applied(Operation::negate, {term.f}), term.g});
    else if (like->g == term.g)
      like->f = applied(operation, {like->f, term.f});
    else
      like->g = applied(operation, {like->g, term.g});
  }
}

/// Of each with each.
SplitTerms combined(Operation operation, const SplitTerms &a, const SplitTerms &b) {
  SplitTerms result;
  for (const SplitTerm &one : a)
    for (const SplitTerm &other : b)
      add_terms(Operation::add, result,
                {{applied(operation, {one.f, other.f}), applied(operation, {one.g, other.g})}});
  return result;
}

SplitTerms power_terms(const SplitPart &base, const SplitPart &exponent) {
  if (exponent.first || exponent.second) return {};
  const double n = *Expression(exponent.factor(), {}).constant();
  if (base.terms.size() == 1 && n == std::floor(n))
    return combined(Operation::power, base.terms, {{exponent.factor(), exponent.factor()}});
  if (n != 1 && n != 2 && n != 3 && n != 4) return {};
  SplitTerms result = base.terms;
  for (int i = 1; i < n && result.size() <= most_terms; ++i)
    result = combined(Operation::multiply, result, base.terms);
  return result;
}

SplitTerms branch_terms(const SplitPart &otherwise, const SplitPart &if_so,
                        const SplitPart &condition) {
  if (condition.mixed()) return {};
  SplitTerms result;
  for (const SplitPart *branch : {&otherwise, &if_so})
    for (SplitTerm term : branch->terms) {
      Program &guarded = condition.second ? term.g : term.f;
      guarded = branch == &if_so
                    ? applied(Operation::choose, {zero_program, guarded, condition.factor()})
                    : applied(Operation::choose, {guarded, zero_program, condition.factor()});
      add_terms(Operation::add, result, {term});
    }
  return result;
}

/// Of operands that together have names of both groups; empty: does not split.
SplitTerms mixed_terms(Operation operation, const SplitPart *operands) {
  const SplitPart &a = operands[0];
  SplitTerms result;
  switch (operation) {
  case Operation::negate:
    add_terms(Operation::subtract, result, a.terms);
    return result;
  case Operation::add:
  case Operation::subtract:
    result = a.terms;
    add_terms(operation, result, operands[1].terms);
    return result;
  case Operation::multiply:
    return combined(operation, a.terms, operands[1].terms);
  case Operation::divide:
    if (operands[1].terms.size() == 1) return combined(operation, a.terms, operands[1].terms);
    return {};
  case Operation::power:
    return power_terms(a, operands[1]);
  case Operation::choose:
    return branch_terms(a, operands[1], operands[2]);
  default:
    return {};
  }
}

} // namespace

std::optional<SeparatedSum> separated(const Expression &expression,
                                      const std::vector<std::string> &first_group) {
  std::vector<SplitPart> stack;
  for (const Instruction &step : expression.program()) {
    const SplitPart *operands = stack.data() + stack.size() - operands_of(step.operation);
    SplitPart part;
    std::vector<Program> factors;
    for (const SplitPart *one = operands; one != stack.data() + stack.size(); ++one) {
      part.first |= one->first;
      part.second |= one->second;
      factors.push_back(one->factor());
    }
    if (factors.empty()) {
      const bool first =
          step.operation == Operation::name && std::count(first_group.begin(), first_group.end(),
                                                          expression.free_names()[step.name]) > 0;
      part = {first, step.operation == Operation::name && !first, {}};
    }
    if (part.mixed()) {
      part.terms = mixed_terms(step.operation, operands);
    } else {
      const Program all = factors.empty() ? Program{step} : applied(step.operation, factors);
      part.terms = {part.second ? SplitTerm{one_program, all} : SplitTerm{all, one_program}};
    }
    if (part.terms.empty() || part.terms.size() > most_terms) return std::nullopt;
    stack.resize(stack.size() - factors.size());
    stack.push_back(std::move(part));
  }
  SeparatedSum result;
  for (const SplitTerm &term : stack[0].terms)
    result.emplace_back(Expression(term.f, expression.free_names()),
                        Expression(term.g, expression.free_names()));
  return result;
}

} // namespace rbvi
