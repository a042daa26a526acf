#include "expression_machine.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

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

namespace {

double evaluated(Operation operation, const std::array<double, 3> &operands) {
  std::array<double, 4> registers{operands[0], operands[1], operands[2]};
  with_operation(operation, ValueStep{registers.data(), ProgramStep{operation, 3, 0, 1, 2}});
  return registers[3];
}

constexpr double most_factors = 16; ///< of an integer power that is a product

/// text(): where the name is.
template <class Text>
std::size_t position(const std::vector<std::string> &names, const std::string &name,
                     const Text &text) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw bad_input("unknown name '" + name + "' in '" + text() + "'" +
                    (names.empty() ? ": no name is known here"
                                   : ": the nearest is '" + nearest_name(name, names) + "'"));
  return static_cast<std::size_t>(found - names.begin());
}

/// A number that a program computes: each operation on the same operands is one node.
struct ProgramBuilder {
  struct Node {
    Operation operation;
    std::array<int, 3> of{}; ///< nodes before it
    double number = 0;
    bool fixed = true; ///< without coordinates
  };
  std::vector<Node> nodes;
  std::map<std::tuple<Operation, std::array<int, 3>, std::uint64_t>, int> known;
  std::vector<std::string> names; ///< parameters, coordinates, then lets
  std::vector<int> node_of_name;

  int added(const Node &node) {
    const auto [place, is_new] = known.emplace(
        std::tuple(node.operation, node.of, std::bit_cast<std::uint64_t>(node.number)),
        static_cast<int>(nodes.size()));
    if (is_new) nodes.push_back(node);
    return place->second;
  }

  int number(double value) { return added({Operation::number, {}, value}); }
  bool is_number(int node) const { return nodes[node].operation == Operation::number; }

  int applied(Operation operation, const std::array<int, 3> &of) {
    const int count = operands_of(operation);
    const auto all = [&](const auto &what) {
      return std::all_of(of.begin(), of.begin() + count, what);
    };
    if (all([&](int i) { return is_number(i); }))
      return number(
          evaluated(operation, {nodes[of[0]].number, nodes[of[1]].number, nodes[of[2]].number}));
    if (operation == Operation::choose && is_number(of[2]))
      return nodes[of[2]].number != 0 ? of[1] : of[0];
    if (operation == Operation::power && is_number(of[1])) {
      const double n = nodes[of[1]].number;
      if (n == std::floor(n) && std::abs(n) <= most_factors) return integer_power(of[0], int(n));
    }
    return added({operation, of, 0, all([&](int i) { return nodes[i].fixed; })});
  }

  int integer_power(int base, int n) {
    int result = number(1);
    if (n < 0) return integer_power(applied(Operation::divide, {result, base}), -n);
    for (bool first = true; n > 0; n /= 2) {
      if (n % 2 == 1) result = first ? base : applied(Operation::multiply, {result, base});
      first &= n % 2 == 0;
      if (n > 1) base = applied(Operation::multiply, {base, base});
    }
    return result;
  }

  int compiled(const Expression &expression) {
    std::vector<int> place;
    for (const std::string &name : expression.free_names())
      place.push_back(node_of_name[position(names, name, [&] { return expression.text(); })]);
    std::vector<int> stack;
    for (const Instruction &step : expression.program()) {
      const int count = operands_of(step.operation);
      std::array<int, 3> of{};
      std::copy(stack.end() - count, stack.end(), of.begin());
      stack.resize(stack.size() - count);
      stack.push_back(step.operation == Operation::number ? number(step.number)
                      : step.operation == Operation::name ? place[step.name]
                                                          : applied(step.operation, of));
    }
    return stack[0];
  }

  void name(const std::string &name, int node) {
    if (parse_expression(name).free_names() != std::vector{name})
      throw bad_input("'" + name + "' is not a name: letters, digits and _ make one");
    if (std::count(names.begin(), names.end(), name) > 0)
      throw bad_input("the name '" + name + "' is given twice");
    names.push_back(name);
    node_of_name.push_back(node);
  }

  /// The last node that needs each; -1: none does.
  std::vector<int> last_uses(const std::vector<int> &results) const;
  BoundProgram program(const std::vector<int> &results, int parameters, int coordinates,
                       const std::vector<std::string> &by) const;
};

std::vector<int> ProgramBuilder::last_uses(const std::vector<int> &results) const {
  const int size = static_cast<int>(nodes.size());
  std::vector<int> last(size, -1);
  for (const int result : results)
    last[result] = size;
  for (int i = size; i-- > 0;)
    for (int k = 0; k < operands_of(nodes[i].operation) && last[i] >= 0; ++k)
      last[nodes[i].of[k]] = std::max(last[nodes[i].of[k]], i);
  return last;
}

BoundProgram ProgramBuilder::program(const std::vector<int> &results, int parameters,
                                     int coordinates, const std::vector<std::string> &by) const {
  const int size = static_cast<int>(nodes.size());
  std::vector<int> last = last_uses(results), target(size), free;
  ProgramCode bound;
  bound.parameters = parameters;
  bound.coordinates = coordinates;
  int registers = 0;
  for (int i = 0; i < size; ++i)
    if (last[i] >= 0 && is_number(i)) {
      bound.constants.push_back(nodes[i].number);
      target[i] = registers++;
    }
  for (int i = 0; i < parameters; ++i)
    target[node_of_name[i]] = registers++;
  const auto add_step = [&](std::vector<ProgramStep> &steps, int i) {
    const auto at = [&](int k) { return static_cast<unsigned short>(target[nodes[i].of[k]]); };
    steps.push_back(
        {nodes[i].operation, static_cast<unsigned short>(target[i]), at(0), at(1), at(2)});
  };
  const auto is_step = [&](int i) { return last[i] >= 0 && nodes[i].operation > Operation::name; };
  for (int i = 0; i < size; ++i)
    if (is_step(i) && nodes[i].fixed) {
      target[i] = registers++;
      add_step(bound.fixed, i);
    }
  bound.first_coordinate = registers;
  for (int i = 0; i < coordinates; ++i)
    target[node_of_name[parameters + i]] = registers++;
  for (int i = 0; i < size; ++i)
    if (is_step(i) && !nodes[i].fixed) {
      if (free.empty()) free.push_back(registers++);
      target[i] = free.back();
      free.pop_back();
      add_step(bound.steps, i);
      for (int k = 0; k < operands_of(nodes[i].operation); ++k) {
        const int operand = nodes[i].of[k];
        if (last[operand] != i || nodes[operand].fixed || !is_step(operand)) continue;
        free.push_back(target[operand]);
        last[operand] = size; // once, where it is two operands
      }
    }
  if (registers > most_registers)
    throw bad_input("expressions have to keep " + std::to_string(registers) +
                    " numbers at once, more than " + std::to_string(most_registers) +
                    ": write them with fewer values that several terms share");
  for (const int result : results)
    bound.results.push_back(target[result]);
  const std::vector<std::string> given(names.begin(), names.begin() + parameters + coordinates);
  for (const std::string &name : by)
    bound.by.push_back(target[node_of_name[position(
        given, name, [] { return std::string("the names of a gradient"); })]]);
  return BoundProgram(std::move(bound));
}

} // namespace

BoundProgram bound_program(const Lets &lets, const std::vector<Expression> &results,
                           const std::vector<std::string> &parameters,
                           const std::vector<std::string> &coordinates,
                           const std::vector<std::string> &by) {
  ProgramBuilder builder;
  for (const auto *group : {&parameters, &coordinates})
    for (const std::string &name : *group)
      builder.name(
          name,
          builder.added({Operation::name, {}, double(builder.names.size()), group == &parameters}));
  for (const auto &[name, value] : lets)
    builder.name(name, builder.compiled(value));
  std::vector<int> nodes;
  for (const Expression &result : results)
    nodes.push_back(builder.compiled(result));
  return builder.program(nodes, static_cast<int>(parameters.size()),
                         static_cast<int>(coordinates.size()), by);
}

} // namespace rbvi
