#include "rbvi/core/error.hpp"
#include "rbvi/core/expression.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <numbers>

namespace rbvi {

namespace {

enum Precedence {
  of_choice,
  of_or,
  of_and,
  of_not,
  of_comparison,
  of_sum,
  of_product,
  of_sign,
  of_power,
  of_operand
};

struct Spelling {
  std::string text;
  Precedence precedence; ///< of_operand: a function
};

/// In the order of the operations, negate first.
const std::array<Spelling, 40> spellings{{
    // clang-format off
    {"-", of_sign}, {"not", of_not}, {"sqrt", of_operand}, {"cbrt", of_operand},
    {"exp", of_operand}, {"log", of_operand}, {"log10", of_operand}, {"log2", of_operand},
    {"sin", of_operand}, {"cos", of_operand}, {"tan", of_operand}, {"asin", of_operand},
    {"acos", of_operand}, {"atan", of_operand}, {"sinh", of_operand}, {"cosh", of_operand},
    {"tanh", of_operand}, {"abs", of_operand}, {"sign", of_operand}, {"floor", of_operand},
    {"ceil", of_operand},
    {"+", of_sum}, {"-", of_sum}, {"*", of_product}, {"/", of_product}, {"^", of_power},
    {"<", of_comparison}, {"<=", of_comparison}, {">", of_comparison}, {">=", of_comparison},
    {"==", of_comparison}, {"!=", of_comparison}, {"and", of_and}, {"or", of_or},
    {"atan2", of_operand}, {"min", of_operand}, {"max", of_operand}, {"hypot", of_operand},
    {"?", of_choice}, {"pow", of_operand}
    // clang-format on
}};

const Spelling &spelling(Operation operation) {
  return spellings[static_cast<std::size_t>(operation) -
                   static_cast<std::size_t>(Operation::negate)];
}

/// Operation::number if there is none.
Operation spelled(const std::string &text, bool function) {
  if (function && text == "pow") return Operation::power;
  for (int i = static_cast<int>(function ? Operation::sqrt : Operation::add);
       i < static_cast<int>(Operation::choose); ++i)
    if (const Spelling &one = spelling(Operation(i));
        one.text == text && (one.precedence == of_operand) == function)
      return Operation(i);
  return Operation::number;
}

struct Parser {
  explicit Parser(std::string_view text) : source(text) {}

  const std::string source;
  enum Kind { number, name, symbol, end } kind = end; ///< of the token that is next
  std::string token;
  std::size_t begin = 0, behind = 0; ///< of the token
  double value = 0;                  ///< of a number
  std::vector<std::string> names;
  int nested = 0;

  [[noreturn]] void refuse(std::size_t at, const std::string &what) const {
    std::string line = source;
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return c < ' '; }, ' ');
    throw bad_input("column " + std::to_string(at + 1) + " of '" + line + "': " + what);
  }

  [[noreturn]] void refuse_token() const {
    for (const auto &[theirs, ours] :
         {std::pair{"**", "^"}, {"&&", "and"}, {"||", "or"}, {"!", "not"}, {"=", "=="}})
      if (token == theirs) refuse(begin, "write " + std::string(ours) + " for " + token);
    if (kind == number || kind == name || token == "(")
      refuse(begin, "an operator is missing before '" + token + "'");
    if (token == ")") refuse(begin, "')' closes nothing");
    if (token == ",") refuse(begin, "a comma stands between the arguments of a function alone");
    refuse(begin, "'" + token + "' cannot stand here");
  }

  void next() {
    begin = source.find_first_not_of(" \t\r\n", behind);
    if (begin == std::string::npos) begin = source.size();
    behind = begin + 1;
    const auto at = [&](std::size_t i) { return i < source.size() ? source[i] : '\0'; };
    const auto is_letter = [&](char c) {
      return std::isalpha(static_cast<unsigned char>(c)) || c == '_';
    };
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const char c = at(begin);
    if (is_digit(c) || (c == '.' && is_digit(at(begin + 1)))) {
      kind = number;
      const char *first = source.data() + begin;
      const auto [last, error] = std::from_chars(first, source.data() + source.size(), value);
      behind = begin + static_cast<std::size_t>(last - first);
      if (error != std::errc())
        refuse(begin, "this number is outside the range of double precision");
    } else if (is_letter(c)) {
      kind = name;
      while (is_letter(at(behind)) || is_digit(at(behind)))
        ++behind;
    } else {
      kind = begin < source.size() ? symbol : end;
      const std::string two = source.substr(begin, 2);
      for (const char *pair : {"<=", ">=", "==", "!=", "**", "&&", "||"})
        if (two == pair) behind = begin + 2;
      while ((at(behind) & 0xC0) == 0x80) // the rest of a character of UTF-8
        ++behind;
    }
    token = source.substr(begin, behind - begin);
  }

  /// Whatever binds as tightly as this, or more.
  Program expression(Precedence loosest) {
    if (++nested > 64) refuse(begin, "nested deeper than 64: write it in smaller parts");
    Program left = operand(loosest);
    for (bool compared = false;;) {
      const Operation operation = spelled(token, false);
      if (operation == Operation::number || spelling(operation).precedence < loosest) break;
      const Precedence precedence = spelling(operation).precedence;
      if (compared && precedence == of_comparison)
        refuse(begin, "write a < b and b < c for a < b < c");
      compared = precedence == of_comparison;
      next();
      append(left, expression(precedence == of_power ? of_sign : Precedence(precedence + 1)),
             operation);
    }
    if (loosest == of_choice && token == "?") {
      next();
      const Program if_so = expression(of_choice);
      if (token != ":") refuse(begin, "':' is missing: condition ? value : value otherwise");
      next();
      Program otherwise = expression(of_choice);
      otherwise.insert(otherwise.end(), if_so.begin(), if_so.end());
      append(otherwise, left, Operation::choose);
      left = std::move(otherwise);
    }
    --nested;
    return left;
  }

  static void append(Program &left, const Program &right, Operation operation) {
    left.insert(left.end(), right.begin(), right.end());
    left.push_back({operation});
  }

  Program operand(Precedence loosest) {
    const std::string here = token;
    const std::size_t column = begin;
    if (kind == number || here == "pi") {
      const Program result{{Operation::number, 0, kind == number ? value : std::numbers::pi}};
      next();
      return result;
    }
    if (here == "-" || here == "+" || here == "not") {
      const bool is_not = here == "not";
      if (is_not && loosest > of_not) refuse(column, "write (not ...) in an operand");
      next();
      Program result = expression(is_not ? of_not : of_sign);
      if (here != "+") result.push_back({is_not ? Operation::negation : Operation::negate});
      return result;
    }
    if (here == "(") {
      next();
      Program result = expression(of_choice);
      close(column);
      return result;
    }
    if (kind != name || here == "and" || here == "or") {
      for (const char *other : {"**", "&&", "||", "!", "="})
        if (here == other) refuse_token();
      refuse(column,
             "a number, a name or '(' is missing" + (kind == end ? "" : " before '" + here + "'"));
    }
    next();
    if (token == "(") return call(here, column);
    if (spelled(here, true) != Operation::number)
      refuse(column, here + " is a function: write " + here + "(...)");
    const auto found = std::find(names.begin(), names.end(), here);
    const int place = static_cast<int>(found - names.begin());
    if (found == names.end()) names.push_back(here);
    return {{Operation::name, place}};
  }

  void close(std::size_t open) {
    if (kind == end) refuse(open, "'(' is not closed");
    if (token != ")") refuse_token();
    next();
  }

  Program call(const std::string &function, std::size_t column) {
    const Operation operation = spelled(function, true);
    if (operation == Operation::number) {
      std::vector<std::string> known;
      for (const Spelling &one : spellings)
        if (one.precedence == of_operand) known.push_back(one.text);
      refuse(column, "unknown function '" + function + "': the nearest is '" +
                         nearest_name(function, known) + "'");
    }
    const std::size_t open = begin;
    const int wanted = operands_of(operation);
    const bool any = operation >= Operation::min && operation <= Operation::hypot;
    Program result;
    int given = 0;
    do {
      next();
      const Program argument = expression(of_choice);
      result.insert(result.end(), argument.begin(), argument.end());
      if (++given > 1 && wanted == 2) result.push_back({operation});
    } while (token == ",");
    close(open);
    if (wanted == 1 && given == 1) result.push_back({operation});
    if (given != wanted && !(any && given > wanted))
      refuse(column, function + " takes " + counted(wanted, "argument") + (any ? " or more" : "") +
                         ", not " + std::to_string(given));
    return result;
  }
};

} // namespace

Expression parse_expression(std::string_view text) {
  Parser parser(text);
  parser.next();
  if (parser.kind == Parser::end) throw bad_input("an expression is empty: a number is needed");
  Program program = parser.expression(of_choice);
  if (parser.kind != Parser::end) parser.refuse_token();
  return {std::move(program), parser.names};
}

std::string Expression::text() const {
  struct Written {
    std::string text;
    Precedence precedence;
    std::string at_least(int loosest) const {
      return precedence < loosest ? "(" + text + ")" : text;
    }
  };
  std::vector<Written> stack;
  for (const Instruction &step : program_) {
    const int operands = operands_of(step.operation);
    if (operands == 0) {
      stack.push_back({step.operation == Operation::name ? names_[step.name]
                       : step.number == std::numbers::pi ? "pi"
                                                         : shortest_number(step.number),
                       of_operand});
      continue;
    }
    const auto &[name, precedence] = spelling(step.operation);
    const Written *of = stack.data() + stack.size() - operands;
    Written all{"", precedence};
    if (operands == 3)
      all.text = of[2].at_least(of_or) + " ? " + of[1].text + " : " + of[0].text;
    else if (precedence == of_operand)
      all.text = name + "(" + of[0].text + (operands == 2 ? ", " + of[1].text : "") + ")";
    else if (operands == 1)
      all.text = name + (precedence == of_not ? " " : "") + of[0].at_least(precedence);
    else if (precedence == of_power)
      all.text = of[0].at_least(of_operand) + "^" + of[1].at_least(of_sign);
    else
      all.text = of[0].at_least(precedence + (precedence == of_comparison)) + " " + name + " " +
                 of[1].at_least(precedence + 1);
    stack.resize(stack.size() - operands);
    stack.push_back(all);
  }
  return stack[0].text;
}

} // namespace rbvi
