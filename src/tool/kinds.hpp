// The kinds of options: what their values are, how they are read into their place and shown.
#pragma once

#include "table.hpp"

#include "rbvi/core/text.hpp"

#include <type_traits>

namespace rbvi {

/// Largest relative error that a reduced model may be asked for: above, it says nothing.
constexpr double rough = 0.5;

inline const Range relative_error{0, rough}, positive{0, 1e300}, refinements{0, 6};

// Values from text. They throw bad_input, naming the option.

double number_of(const std::string &name, const std::string &value, const Range &range);
int integer_of(const std::string &name, const std::string &value, const Range &range);
/// "0,1,2"
std::vector<int> rising_of(const std::string &name, const std::string &value, const Range &range);
bool flag_of(const std::string &name, const std::string &value);
/// Position of the value among the choices.
int choice_of(const std::string &name, const std::string &value, const std::vector<Choice> &all);

/// "0 to 0.5"
std::string in_words(const Range &range);

/// Names of an enumeration, and what each means.
std::vector<Choice> choices(const std::vector<std::string> &names,
                            const std::vector<std::string> &meanings);

/// The shortest text of a number: "1e-6".
std::string plain(double number);

/// A value as text; of an optional one that is not set "".
template <class Value> std::string as_text(const Value &value, std::string (*write)(double)) {
  if constexpr (std::is_same_v<Value, bool>)
    return value ? "yes" : "no";
  else if constexpr (std::is_integral_v<Value>)
    return std::to_string(value);
  else if constexpr (std::is_same_v<Value, std::optional<double>>)
    return value ? write(*value) : "";
  else if constexpr (std::is_same_v<Value, double>)
    return write(value);
  else
    return std::filesystem::path(value).string();
}

/// A description with the default that the place has.
template <class Value> Option placed(Option option, Value &place) {
  option.shown = [&place] { return as_text(place, short_number); };
  option.default_value = as_text(place, plain);
  return option;
}

/// For these runs alone; of several options those that are not for others.
Option only(const Use &use, Option option);
std::vector<Option> only(const Use &use, std::vector<Option> options);

/// A reduction would take it, or tell of it, and not follow: refused wherever it has no effect.
Option never_waits(Option option);

/// Models of the runs that it is for, or of `runs`, keep the value, as the setting `as`: by default
/// of the same name.
Option kept(Option option, const std::string &as = "");
Option kept(const Use &runs, Option option);

/// What stands in place of a value that is not given.
Option otherwise(const std::string &value, Option option);

/// Options behind those of `all`, below a heading.
void add(const char *group, std::vector<Option> options, std::vector<Option> &all);

// Options by the kind of their values; each place outlives its option.

template <class Value>
Option number(const std::string &name, const Range &range, Value &place, const std::string &help) {
  constexpr bool whole = std::is_integral_v<Value>;
  Option option{name, whole ? OptionKind::integer : OptionKind::number, help};
  option.values = (whole ? "integer, " : "") + in_words(range);
  option.read = [=, &place](const std::string &value) {
    if constexpr (whole)
      place = integer_of(name, value, range);
    else
      place = number_of(name, value, range);
  };
  return placed(std::move(option), place);
}

/// Integers, each larger than the one before it; none where it is not given.
inline Option rising(const std::string &name, const Range &range, std::vector<int> &place,
                     const std::string &help) {
  Option option{name, OptionKind::text, help, "rising integers 0,1,...: each " + in_words(range)};
  option.read = [=, &place](const std::string &value) { place = rising_of(name, value, range); };
  return option;
}

inline Option flag(const std::string &name, bool &place, const std::string &help) {
  Option option{name, OptionKind::flag, help, "yes, no"};
  option.read = [=, &place](const std::string &value) { place = flag_of(name, value); };
  return placed(std::move(option), place);
}

/// The place holds an enumeration, or yes for the second of two choices.
template <class Value>
Option choice(const std::string &name, const std::vector<Choice> &all, Value &place,
              const std::string &help) {
  Option option{name, OptionKind::choice, help};
  option.choices = all;
  option.read = [=, &place](const std::string &value) {
    place = static_cast<Value>(choice_of(name, value, all));
  };
  option.shown = [=, &place] { return all[static_cast<std::size_t>(place)].name; };
  option.default_value = option.shown();
  return option;
}

/// Text, the name of a file or a set: whoever uses it reads it.
template <class Value>
Option text(const std::string &name, OptionKind kind, const std::string &values, Value &place,
            const std::string &help) {
  Option option{name, kind, help, values};
  option.read = [&place](const std::string &value) { place = value; };
  return placed(std::move(option), place);
}

} // namespace rbvi
