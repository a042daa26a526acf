// Functions that a file can name. A *record* holds the name, the version and the constants of a
// function; a *maker* of that name and version makes the same function from them in every build
// that has it (Registry in core/scene.hpp).
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rbvi {

/// What a file stores of a function, of a kind of contact or of a whole scene.
struct Record {
  std::string name = ""; ///< "": no maker makes it
  int version = 1;
  std::map<std::string, std::vector<double>> numbers{};
  std::map<std::string, std::string> texts{};
  std::map<std::string, Record> parts{}; ///< functions that it is made of
};

struct Registry;

/// A record that is read, and where the names in it are looked up; null: nowhere.
struct Stored {
  const Record &record;
  const Registry *registry = nullptr;
  operator const Record &() const { return record; }
};

/// One number of a record, several, a text. Throws bad_input, naming the record, where they are not
/// there.
double number(const Record &record, const std::string &name);
int integer(const Record &record, const std::string &name);
const std::vector<double> &numbers(const Record &record, const std::string &name);
const std::string &text(const Record &record, const std::string &name);
const Record &part(const Record &record, const std::string &name);
Stored part(const Stored &stored, const std::string &name);
/// Whether the record has a number that is not 0; without it: no.
bool is_set(const Record &record, const std::string &name);

/// Whether the record and all its parts have names; else "map", "contact 0/height", ...: the first
/// part that has none.
bool is_complete(const Record &record);
std::string first_unnamed(const Record &record);

/// A function with its record. A plain function or a lambda has none.
template <class Signature> class Named : public std::function<Signature> {
public:
  using std::function<Signature>::function;
  Named() = default;
  Named(std::function<Signature> callable, Record of)
      : std::function<Signature>(std::move(callable)), record(std::move(of)) {}
  Record record{};
};

/// Makes the functions of one name: the same for the same record.
template <class Signature> struct Maker {
  std::string name;
  int version;
  std::function<std::function<Signature>(const Stored &)> make;

  /// The function of these constants.
  Named<Signature> operator()(std::map<std::string, std::vector<double>> numbers = {}) const {
    Record record{name, version, std::move(numbers)};
    return {make({record}), record};
  }
  /// A function made of others, which need not have names themselves.
  Named<Signature> named(std::function<Signature> callable,
                         std::map<std::string, std::vector<double>> numbers,
                         std::map<std::string, Record> parts) const {
    return {std::move(callable), {name, version, std::move(numbers), {}, std::move(parts)}};
  }
};

/// The maker of a function without constants.
template <class Signature, class Function>
Maker<Signature> plain(std::string name, int version, Function function) {
  return {std::move(name), version,
          [function](const Record &) -> std::function<Signature> { return function; }};
}

} // namespace rbvi
