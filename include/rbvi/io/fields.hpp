// Lists of fields. What a file holds is listed once, by a template of a store and of what is
// stored:
//
//   template <class Store, class Thing> void list(const Store &store, Thing &thing) {
//     store("a/range", thing.range, Shape{n, r});
//
// A store writes the fields that it is shown, reads them, or checks what the list says of them. It
// has `reads`, a call for each type that H5Writer writes, and `ask` for conditions between fields;
// the functions below make other types of these. A store that does not read is shown const things.
#pragma once

#include "rbvi/io/h5.hpp"

#include <array>
#include <map>
#include <tuple>

namespace rbvi {

inline constexpr Index any_size = -1;

/// Said of a matrix, which then has finite entries, too.
struct Shape {
  Index rows, columns;
};

/// Said of indices: all in lowest .. bound - 1, `count` of them.
struct Indices {
  Index bound, count = any_size;
  int lowest = 0;
};

/// Said of an integer: in lowest .. highest.
struct Between {
  Index lowest, highest;
};

/// File: H5Writer or ImageWriter.
template <class File> struct WriterTo {
  static constexpr bool reads = false, checks = false;
  File &file;
  template <class T, class... Said>
  void operator()(const std::string &name, const T &value, Said...) const {
    file.write(name, value);
  }
  template <class Holds> void ask(const std::string &, Holds &&) const {}
};

/// File: H5Reader or ImageReader. Throws bad_input, naming the data set, for one that is none of
/// ours.
template <class File> struct ReaderOf {
  static constexpr bool reads = true, checks = false;
  const File &file;
  template <class T, class... Said>
  void operator()(const std::string &name, T &value, Said...) const {
    using Numbers = std::vector<double>; // of which Mu is one
    using InFile = std::conditional_t<std::is_base_of_v<Numbers, T>, Numbers, T>;
    static_cast<InFile &>(value) = file.template read<InFile>(name);
  }
  template <class Holds> void ask(const std::string &, Holds &&) const {}
};

using FieldWriter = WriterTo<H5Writer>;
using FieldReader = ReaderOf<H5Reader>;

/// A value that is stored as to(value), and read as from(stored).
template <class Store, class T, class To, class From, class... Said>
void list_as(const Store &store, const std::string &name, T &value, To &&to, From &&from,
             Said... said) {
  std::decay_t<decltype(to(value))> stored{};
  if constexpr (!Store::reads) stored = to(value);
  store(name, stored, said...);
  if constexpr (Store::reads) value = from(stored);
}

/// A bool or an enum.
template <class Store, class T, class... Said>
void list_integer(const Store &store, const std::string &name, T &value, Said... said) {
  list_as(
      store, name, value, [](auto of) { return static_cast<int>(of); },
      [](int stored) { return static_cast<T>(stored); }, said...);
}

/// Of each element the numbers tie(element), a std::tie, one element behind the other. A container
/// of a fixed size has to fit.
template <class Store, class List, class Tie>
void list_records(const Store &store, const std::string &name, List &list, Tie &&tie) {
  using Numbers = decltype(tie(*std::begin(list)));
  constexpr std::size_t size = std::tuple_size_v<Numbers>;
  using Number = decltype(std::apply([](auto... x) { return (x + ...); }, std::declval<Numbers>()));
  std::vector<Number> stored;
  if constexpr (!Store::reads)
    for (auto &element : list)
      std::apply([&](auto &...x) { (stored.push_back(static_cast<Number>(x)), ...); },
                 tie(element));
  store(name, stored);
  if constexpr (Store::reads) {
    if constexpr (requires { list.resize(0); }) list.resize(stored.size() / size);
    if (stored.size() != std::size(list) * size)
      throw bad_input(name + " has no " + std::to_string(size) + " numbers of each");
    auto next = stored.begin();
    for (auto &element : list)
      std::apply([&](auto &...x) { ((x = static_cast<std::decay_t<decltype(x)>>(*next++)), ...); },
                 tie(element));
  }
}

/// A single record.
template <class Store, class Tuple>
void list_record(const Store &store, const std::string &name, const Tuple &record) {
  std::array one{record};
  list_records(store, name, one, [](const Tuple &of) { return of; });
}

/// member(element) of each element. Columns of one list have one length, which the first gives it.
template <class Store, class List, class Member>
void list_column(const Store &store, const std::string &name, List &list, Member &&member) {
  std::vector<std::decay_t<decltype(member(*list.begin()))>> stored;
  if constexpr (!Store::reads)
    for (auto &element : list)
      stored.push_back(member(element));
  store(name, stored);
  if constexpr (Store::reads) {
    if (list.empty()) list.resize(stored.size());
    if (stored.size() != list.size())
      throw bad_input(name + " is not as long as what is beside it");
    for (std::size_t i = 0; i < list.size(); ++i)
      member(list[i]) = stored[i];
  }
}

template <class Store, class Map>
void list_map(const Store &store, const std::string &keys, const std::string &values, Map &map) {
  std::vector<std::pair<typename Map::key_type, typename Map::mapped_type>> pairs;
  if constexpr (!Store::reads) pairs.assign(map.begin(), map.end());
  list_column(
      store, keys, pairs, [](auto &pair) -> auto & { return pair.first; });
  list_column(
      store, values, pairs, [](auto &pair) -> auto & { return pair.second; });
  if constexpr (Store::reads) map = Map(pairs.begin(), pairs.end());
}

/// How many elements there are, then visit("group/0", element), ...
template <class Store, class List, class Visit>
void list_elements(const Store &store, const std::string &count, const std::string &group,
                   List &list, Visit &&visit) {
  int size = static_cast<int>(std::ssize(list));
  store(count, size);
  for (int i = 0; i < size; ++i) {
    if constexpr (Store::reads) list.emplace_back();
    visit(group + "/" + std::to_string(i), list[i]);
  }
}

} // namespace rbvi
