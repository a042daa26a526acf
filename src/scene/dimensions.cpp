#include "dimensions.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Of what is on the stack; a number keeps its value, as it may be a power.
struct Operand {
  std::optional<Dimension> dimension{};
  std::optional<double> number{};
};

/// Of a sum, a comparison or a choice.
std::optional<Dimension> common(const Operand &one, const Operand &other) {
  if (one.dimension && other.dimension && *one.dimension != *other.dimension)
    throw bad_input("adds or compares " + described(*one.dimension) + " and " +
                    described(*other.dimension));
  return one.dimension ? one.dimension : other.dimension;
}

/// one other^sign.
std::optional<Dimension> product(const Operand &one, const Operand &other, int sign) {
  if (!one.dimension || !other.dimension) return std::nullopt;
  Dimension all = *one.dimension;
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] += sign * (*other.dimension)[i];
  return all;
}

/// Of one to a power that is a number, where it is whole.
std::optional<Dimension> power(const Operand &one, double exponent) {
  if (!one.dimension) return std::nullopt;
  Dimension all{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double own = (*one.dimension)[i] * exponent;
    all[i] = static_cast<int>(own);
    if (all[i] != own) return std::nullopt;
  }
  return all;
}

Operand result(Operation operation, const Operand *of) {
  using Op = Operation;
  const auto is = [&](std::initializer_list<Op> some) {
    return std::ranges::find(some, operation) != some.end();
  };
  if (is({Op::negate}))
    return {of[0].dimension, of[0].number ? std::optional(-*of[0].number) : std::nullopt};
  if (is({Op::abs})) return {of[0].dimension};
  if (is({Op::sqrt})) return {power(of[0], 0.5)};
  if (is({Op::multiply, Op::divide}))
    return {product(of[0], of[1], operation == Op::multiply ? 1 : -1)};
  if (is({Op::power})) return {of[1].number ? power(of[0], *of[1].number) : std::nullopt};
  if (is({Op::add, Op::subtract, Op::min, Op::max, Op::hypot, Op::choose}))
    return {common(of[0], of[1])};
  if (is({Op::less, Op::at_most, Op::greater, Op::at_least, Op::equal, Op::different, Op::atan2}))
    (void)common(of[0], of[1]);
  return {};
}

} // namespace

Dimensions::Dimensions(const Reader &reader) {
  if (!reader.units) return;
  const Dimension length = dimension_of("m"), stress = dimension_of("Pa");
  of_name_ = {{"nx", {}}, {"ny", {}}, {"nz", {}}, {"slope_x", {}}, {"slope_y", {}}};
  for (const char *name : {"x", "y", "z", "ux", "uy", "uz", "u", "gap", "slip"})
    of_name_[name] = length;
  for (const char *name : {"pressure", "tangential", "sigma_xx", "sigma_yy", "sigma_zz", "sigma_xy",
                           "von_mises", "strain_energy"})
    of_name_[name] = stress;
  const auto put = [&](const std::string &name, const auto &dimension) {
    of_name_.erase(name);
    try {
      if (const std::optional<Dimension> own = dimension()) of_name_[name] = *own;
    } catch (const Error &) { // told where it is read
    }
  };
  for (const auto &[name, node] : section(reader, "parameters").entries)
    put(name, [&, unit = unit_of(node)] {
      return unit.empty() ? std::nullopt : std::optional(dimension_of(unit));
    });
  for (const auto &[name, node] : section(reader, "let").entries)
    put(name, [&, &value = node] { return of(value); });
}

std::optional<Dimension> Dimensions::of(const CaseNode &node) const {
  if (const std::string unit = unit_behind(node.value); !unit.empty()) return dimension_of(unit);
  const Expression expression = parse_expression(node.value);
  std::vector<Operand> stack;
  for (const Instruction &step : expression.program()) {
    Operand next;
    if (step.operation == Operation::number) {
      next.number = step.number;
    } else if (step.operation == Operation::name) {
      const auto found = of_name_.find(expression.free_names()[step.name]);
      if (found != of_name_.end()) next.dimension = found->second;
    } else {
      const auto count = static_cast<std::size_t>(operands_of(step.operation));
      next = result(step.operation, stack.data() + stack.size() - count);
      stack.resize(stack.size() - count);
    }
    stack.push_back(next);
  }
  return stack.back().dimension;
}

void Dimensions::check(const CaseNode &node, const std::string &unit) const {
  for (const CaseNode &item : node.items)
    check(item, unit);
  if (of_name_.empty() || !node.is_value()) return;
  try {
    (void)parse_expression(node.value);
  } catch (const Error &) { // a text, or told elsewhere
    if (unit_behind(node.value).empty()) return;
  }
  std::optional<Dimension> own;
  try {
    own = of(node);
  } catch (const Error &error) {
    throw bad_input("'" + node.value + "' " + error.what());
  }
  if (own && !unit.empty()) check_dimension({1, *own, true}, dimension_of(unit), node.value);
}

} // namespace rbvi
