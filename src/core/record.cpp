#include "rbvi/core/record.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

template <class Map>
const typename Map::mapped_type &member(const Record &record, const Map &map,
                                        const std::string &name) {
  const auto found = map.find(name);
  if (found == map.end())
    throw bad_input("the record of '" + record.name + "' lacks '" + name + "'");
  return found->second;
}

} // namespace

double number(const Record &record, const std::string &name) {
  const std::vector<double> &values = numbers(record, name);
  if (values.size() != 1)
    throw bad_input("'" + name + "' of '" + record.name + "' is not one number");
  return values.front();
}

int integer(const Record &record, const std::string &name) {
  const double value = number(record, name);
  if (!(std::abs(value) < 1e9) || std::trunc(value) != value)
    throw bad_input("'" + name + "' of '" + record.name + "' is not a whole number");
  return static_cast<int>(value);
}

const std::vector<double> &numbers(const Record &record, const std::string &name) {
  return member(record, record.numbers, name);
}

const std::string &text(const Record &record, const std::string &name) {
  return member(record, record.texts, name);
}

const Record &part(const Record &record, const std::string &name) {
  return member(record, record.parts, name);
}

Stored part(const Stored &stored, const std::string &name) {
  return {part(stored.record, name), stored.registry};
}

bool is_set(const Record &record, const std::string &name) {
  return record.numbers.contains(name) && number(record, name) != 0;
}

bool is_complete(const Record &record) {
  return !record.name.empty() &&
         std::ranges::all_of(record.parts, [](const auto &p) { return is_complete(p.second); });
}

std::string first_unnamed(const Record &record) {
  for (const auto &[name, one] : record.parts) {
    if (one.name.empty()) return name;
    if (!is_complete(one)) return name + "/" + first_unnamed(one);
  }
  return "";
}

} // namespace rbvi
