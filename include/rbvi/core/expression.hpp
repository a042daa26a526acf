// Numbers written as expressions in parameters and coordinates.
//
//   expression  = or [ "?" expression ":" expression ]      the branch taken
//   or          = and { "or" and }                          0 is false; what holds is 1
//   and         = not { "and" not }
//   not         = { "not" } comparison
//   comparison  = sum [ ("<" | "<=" | ">" | ">=" | "==" | "!=") sum ]
//   sum         = product { ("+" | "-") product }
//   product     = signed { ("*" | "/") signed }
//   signed      = { "-" | "+" } power
//   power       = operand [ "^" signed ]                    -x^2 = -(x^2), 2^3^2 = 2^9
//   operand     = number | name | "pi" | "(" expression ")"
//               | function "(" expression { "," expression } ")"
//   number      = 1, .5, 1e-3                               name = [A-Za-z_][A-Za-z0-9_]*
//
// Functions: sqrt cbrt exp log (natural) log10 log2 sin cos tan asin acos atan sinh cosh tanh abs
// sign floor ceil; of two numbers pow atan2; of two or more min max hypot. Angles are in radians.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rbvi {

/// By how many operands they take: 0, 1 (negate to ceil), 2 (add to hypot), 3.
enum class Operation : unsigned char {
  // clang-format off
  number, name,
  negate, negation, sqrt, cbrt, exp, log, log10, log2, sin, cos, tan, asin, acos, atan,
  sinh, cosh, tanh, abs, sign, floor, ceil,
  add, subtract, multiply, divide, power, less, at_most, greater, at_least, equal, different,
  both, either, atan2, min, max, hypot,
  choose ///< of the values otherwise, if so and the condition, in this order
  // clang-format on
};

int operands_of(Operation operation);

/// What a stack machine would do in one step.
struct Instruction {
  Operation operation = Operation::number;
  int name = 0;      ///< of a name, its position
  double number = 0; ///< of a number
  bool operator==(const Instruction &) const = default;
};
using Program = std::vector<Instruction>;

/// Immutable: any number of threads may evaluate one.
class Expression {
public:
  /// The positions in the program are those in `names`.
  Expression(Program program, const std::vector<std::string> &names);
  const Program &program() const { return program_; } ///< its names: positions in free_names()
  const std::vector<std::string> &free_names() const { return names_; } ///< sorted, each once
  /// Parses to the same program.
  std::string text() const;
  /// Its value if there are no free names.
  std::optional<double> constant() const;

private:
  Program program_;
  std::vector<std::string> names_;
};

/// Throws bad_input with the column, from 1, of what cannot be read.
Expression parse_expression(std::string_view text);

/// Values by name, each of which may use the names of those before it.
using Lets = std::vector<std::pair<std::string, Expression>>;

/// One operation on registers.
struct ProgramStep {
  Operation operation;
  unsigned short target, a, b, c;
};

/// Registers hold constants, parameters, what has parameters alone, coordinates, the rest. That of
/// a target is none of an operand.
struct ProgramCode {
  std::vector<double> constants;
  std::vector<ProgramStep> fixed, steps; ///< with parameters alone; with coordinates
  std::vector<int> results, by;          ///< registers: of results, of the names of a gradient
  int parameters = 0, first_coordinate = 0, coordinates = 0;
};

/// Expressions in parameters and coordinates that are evaluated together: what they share once,
/// what has parameters alone once per call, what no result needs never. Nothing is allocated in an
/// evaluation; any number of threads may evaluate one. Values that are not finite are returned as
/// they are. Both branches of "?" are evaluated, the value and derivatives are those of the branch
/// taken. Derivatives at kinks: abs at 0 has 1, its own from the right; min and max of equal
/// numbers have those of the first; hypot at (0, 0), sign, floor, ceil, comparisons, and, or, not
/// have 0.
class BoundProgram {
public:
  explicit BoundProgram(ProgramCode code) : code_(std::move(code)) {}
  /// At `count` points. `coordinates`: count x coordinates, `results`: count x results, both column
  /// by column: for one point these are its coordinates and its results.
  void values(const double *parameters, const double *coordinates, std::size_t count,
              double *results) const;
  /// `gradients`: count x (results x by), column by column: for one point, the gradient of the
  /// first result, then that of the second. More points than one take 0.7 MB of stack.
  void values_and_gradients(const double *parameters, const double *coordinates, std::size_t count,
                            double *results, double *gradients) const;

private:
  ProgramCode code_;
};

/// Derivatives come in the order of `by`, which are some of the parameters and coordinates. Throws
/// bad_input for a name that is not known where it is used, is given twice, or is no name.
BoundProgram bound_program(const Lets &lets, const std::vector<Expression> &results,
                           const std::vector<std::string> &parameters,
                           const std::vector<std::string> &coordinates,
                           const std::vector<std::string> &by);

/// One expression with a place for the value of each name: a BoundProgram of one result.
class BoundExpression {
public:
  explicit BoundExpression(BoundProgram program) : program_(std::move(program)) {}
  double value(const double *values) const {
    double result;
    program_.values(nullptr, values, 1, &result);
    return result;
  }
  /// `gradient`: a number for each name of `by` in bound_to().
  void value_and_gradient(const double *values, double &value, double *gradient) const {
    program_.values_and_gradients(nullptr, values, 1, &value, gradient);
  }
  /// At `count` points; `columns`: count x names, column by column.
  void values(const double *columns, std::size_t count, double *results) const {
    program_.values(nullptr, columns, count, results);
  }

private:
  BoundProgram program_;
};

/// Values come in the order of `names`, derivatives in that of `by`, which are some of them. Throws
/// bad_input for a free name, or a name of `by`, that is not in `names`.
BoundExpression bound_to(const Expression &expression, const std::vector<std::string> &names,
                         const std::vector<std::string> &by);
/// With the gradient by all `names`.
BoundExpression bound_to(const Expression &expression, const std::vector<std::string> &names);

/// sum_i f_i g_i, where f_i has names of the first group and g_i has others.
using SeparatedSum = std::vector<std::pair<Expression, Expression>>;

/// By structure: sums, products, quotients by one product f g, integer powers (of sums from 1 to
/// 4), branches whose condition has names of one group alone (where a factor of the branch that is
/// not taken is not finite, so is the sum); terms with an equal factor are joined. Nothing if that
/// fails, or has more than 64 terms.
std::optional<SeparatedSum> separated(const Expression &expression,
                                      const std::vector<std::string> &first_group);

} // namespace rbvi
