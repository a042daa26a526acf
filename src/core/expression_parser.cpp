#include "rbvi/core/error.hpp"
#include "rbvi/core/expression.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
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
  const char *text;
  Precedence precedence; ///< of_operand: a function
};

/// In the order of the operations, negate first.
constexpr std::array<Spelling, 40> spellings{{
    // known before other constants are made
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

/// A function of two operands or more.
bool takes_more(Operation operation) {
  return operation >= Operation::min && operation <= Operation::hypot;
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
  std::map<std::string, int> place_of_name;
  int nested = 0;

  static bool continues(char c) { return (c & 0xC0) == 0x80; } ///< a character of UTF-8

  /// All of a short text, what is around `at` of a long one.
  std::string excerpt(std::size_t at) const {
    constexpr std::size_t most = 80;
    if (source.size() <= most) return source;
    std::size_t first = at - std::min(at, most / 2), last = std::min(source.size(), at + most / 2);
    while (first > 0 && continues(source[first]))
      --first;
    while (last < source.size() && continues(source[last]))
      ++last;
    return (first > 0 ? "..." : "") + source.substr(first, last - first) +
           (last < source.size() ? "..." : "");
  }

  [[noreturn]] void refuse(std::size_t at, const std::string &what) const {
    const auto column = 1 + std::count_if(source.begin(), source.begin() + at,
                                          [](char c) { return !continues(c); });
    std::string line = "column " + std::to_string(column) + " of '" + excerpt(at) + "': " + what;
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
    throw bad_input(line);
  }

  std::string quoted() const { ///< the token
    return "'" + (token.size() > 40 ? token.substr(0, 40) + "..." : token) + "'";
  }

  [[noreturn]] void refuse_token() const {
    for (const auto &[theirs, ours] :
         {std::pair{"**", "^"}, {"&&", "and"}, {"||", "or"}, {"!", "not"}, {"=", "=="}})
      if (token == theirs) refuse(begin, "write " + std::string(ours) + " for " + token);
    if (kind == number || kind == name || token == "(")
      refuse(begin, "an operator is missing before " + quoted());
    if (token == ")") refuse(begin, "')' closes nothing");
    if (token == ",") refuse(begin, "a comma stands between the arguments of a function alone");
    refuse(begin, quoted() + " cannot stand here");
  }

  void next() {
    begin = source.find_first_not_of(" \t\r\n", behind);
    if (begin == std::string::npos) begin = source.size();
    behind = begin + 1;
    const auto at = [&](std::size_t i) { return i < source.size() ? source[i] : '\0'; };
    const auto is_letter = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
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
      while (continues(at(behind)))
        ++behind;
    }
    token = source.substr(begin, behind - begin);
  }

  /// Whatever binds as tightly as this, or more.
  Program expression(Precedence loosest) {
    Program left = operand(loosest);
    for (bool compared = false;;) {
      const Operation operation = spelled(token, false);
      if (operation == Operation::number || spelling(operation).precedence < loosest) break;
      const Precedence precedence = spelling(operation).precedence;
      if (compared && precedence == of_comparison)
        refuse(begin, "write a < b and b < c for a < b < c");
      compared = precedence == of_comparison;
      next();
      append(left, precedence == of_power ? inner(of_sign) : expression(Precedence(precedence + 1)),
             operation);
    }
    if (loosest == of_choice && token == "?") {
      next();
      const Program if_so = inner(of_choice);
      if (token != ":") refuse(begin, "':' is missing: condition ? value : value otherwise");
      next();
      Program otherwise = inner(of_choice);
      otherwise.insert(otherwise.end(), if_so.begin(), if_so.end());
      append(otherwise, left, Operation::choose);
      left = std::move(otherwise);
    }
    return left;
  }

  /// In parentheses, behind a sign and the like.
  Program inner(Precedence loosest) {
    if (++nested > 64) refuse(begin, "nested deeper than 64: write it in smaller parts");
    Program result = expression(loosest);
    --nested;
    return result;
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
      Program result = inner(is_not ? of_not : of_sign);
      if (here != "+") result.push_back({is_not ? Operation::negation : Operation::negate});
      return result;
    }
    if (here == "(") {
      next();
      Program result = inner(of_choice);
      close(column);
      return result;
    }
    if (kind != name || here == "and" || here == "or") {
      for (const char *other : {"**", "&&", "||", "!", "="})
        if (here == other) refuse_token();
      refuse(column,
             "a number, a name or '(' is missing" + (kind == end ? "" : " before " + quoted()));
    }
    next();
    if (token == "(") return call(here, column);
    if (spelled(here, true) != Operation::number)
      refuse(column, here + " is a function: write " + here + "(...)");
    const auto [found, is_new] = place_of_name.emplace(here, static_cast<int>(names.size()));
    if (is_new) names.push_back(here);
    return {{Operation::name, found->second}};
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
        if (one.precedence == of_operand) known.emplace_back(one.text);
      refuse(column, "unknown function '" + function.substr(0, 40) + "': the nearest is '" +
                         nearest_name(function.substr(0, 40), known) + "'");
    }
    const std::size_t open = begin;
    const int wanted = operands_of(operation);
    const bool any = takes_more(operation);
    Program result;
    int given = 0;
    do {
      next();
      const Program argument = inner(of_choice);
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
    Operation operation;
    /// For once.
    std::string at_least(int loosest) {
      return precedence < loosest ? "(" + text + ")" : std::move(text);
    }
  };
  std::vector<Written> stack;
  for (const Instruction &step : program_) {
    const Operation operation = step.operation;
    const int operands = operands_of(operation);
    if (operands == 0) {
      stack.push_back({operation == Operation::name      ? names_[step.name]
                       : step.number == std::numbers::pi ? "pi"
                                                         : shortest_number(step.number),
                       of_operand, operation});
      continue;
    }
    const auto &[word, precedence] = spelling(operation);
    const std::string name = word;
    Written *of = stack.data() + stack.size() - operands;
    Written all{"", precedence, operation};
    if (operands == 3)
      all.text = of[2].at_least(of_or) + " ? " + of[1].text + " : " + of[0].text;
    else if (precedence == of_operand && operands == 2 && takes_more(operation) &&
             of[0].operation == operation)
      all.text = std::move(of[0].text.erase(of[0].text.size() - 1)) + ", " + of[1].text + ")";
    else if (precedence == of_operand)
      all.text = name + "(" + of[0].text + (operands == 2 ? ", " + of[1].text : "") + ")";
    else if (operands == 1)
      all.text = name + (precedence == of_not ? " " : "") + of[0].at_least(precedence);
    else if (precedence == of_power && of[1].precedence < of_sign) // nests less than ^ with ( )
      all = {"pow(" + of[0].text + ", " + of[1].text + ")", of_operand, operation};
    else if (precedence == of_power)
      all.text = of[0].at_least(of_operand) + "^" + of[1].text;
    else
      all.text = of[0].at_least(precedence + (precedence == of_comparison)) + " " + name + " " +
                 of[1].at_least(precedence + 1);
    stack.resize(stack.size() - operands);
    stack.push_back(std::move(all));
  }
  return std::move(stack[0].text);
}

} // namespace rbvi
