// Lists of fields: what a list writes it reads, and what does not fit names its data set.
#include "../core/refuses.hpp"
#include "rbvi/core/parameters.hpp"
#include "rbvi/io/fields.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

namespace rbvi::fields_test {
namespace {

enum class Colour { red, green };

struct Axis {
  int parameter;
  double lower;
  bool operator==(const Axis &) const = default;
};

struct Person {
  std::string name;
  double height;
  bool operator==(const Person &) const = default;
};

struct Thing {
  Matrix matrix = Matrix::Ones(2, 3);
  Mu mu{0.5, 2};
  bool flag = true;
  Colour colour = Colour::green;
  std::vector<Axis> axes{{1, 0.5}, {7, -2}};
  int first = 3, second = 4;
  std::vector<Person> people{{"a", 1.5}, {"b", 2}};
  std::map<std::string, double> seconds{{"pod", 1}, {"cone", 2}};
  std::vector<std::vector<int>> parts{{1, 2}, {}, {3}};
};

template <class Store, class Of> void list(const Store &store, Of &thing) {
  store("matrix", thing.matrix, Shape{2, any_size});
  store("mu", thing.mu);
  list_integer(store, "flag", thing.flag);
  list_integer(store, "colour", thing.colour);
  list_records(store, "axes", thing.axes,
               [](auto &axis) { return std::tie(axis.parameter, axis.lower); });
  list_record(store, "sizes", std::tie(thing.first, thing.second));
  list_column(
      store, "names", thing.people, [](auto &p) -> auto & { return p.name; });
  list_column(
      store, "heights", thing.people, [](auto &p) -> auto & { return p.height; });
  list_map(store, "stages", "seconds", thing.seconds);
  list_elements(store, "count", "parts", thing.parts,
                [&](const std::string &at, auto &part) { store(at, part); });
  store.ask("never asked", [] { return false; });
}

struct Fields : testing::Test {
  std::filesystem::path path = std::filesystem::path(testing::TempDir()) /
                               ("rbvi_fields_" + std::to_string(::getpid()) + ".h5");
  void TearDown() override { std::filesystem::remove(path); }

  H5Reader written(auto &&fill) const {
    H5Writer file;
    fill(FieldWriter{file});
    file.commit(path, "thing", 1);
    return {path, "thing", 1};
  }
};

TEST_F(Fields, AreReadAsTheyWereWritten) {
  const Thing thing;
  const H5Reader file = written([&](const FieldWriter &store) { list(store, thing); });
  Thing copy{{}, {}, false, Colour::red, {}, 0, 0, {}, {}, {}};
  list(FieldReader{file}, copy);
  EXPECT_EQ(copy.matrix, thing.matrix);
  EXPECT_EQ(copy.mu, thing.mu);
  EXPECT_EQ(copy.flag, thing.flag);
  EXPECT_EQ(copy.colour, thing.colour);
  EXPECT_EQ(copy.axes, thing.axes);
  EXPECT_EQ(std::pair(copy.first, copy.second), std::pair(3, 4));
  EXPECT_EQ(copy.people, thing.people);
  EXPECT_EQ(copy.seconds, thing.seconds);
  EXPECT_EQ(copy.parts, thing.parts);
  EXPECT_EQ(file.read<std::vector<int>>("sizes"), (std::vector<int>{3, 4})) << "integers";
  EXPECT_EQ(file.read<std::vector<double>>("axes"), (std::vector<double>{1, 0.5, 7, -2}));
}

TEST_F(Fields, OtherNumbersOfEntriesAreNamed) {
  const H5Reader file = written([](const FieldWriter &store) {
    store("axes", std::vector<double>{1, 2, 3});
    store("sizes", std::vector<int>{1, 2, 3});
    store("names", std::vector<std::string>{"a", "b"});
    store("heights", std::vector<double>{1});
  });
  const FieldReader store{file};
  std::vector<Axis> axes;
  EXPECT_TRUE(refuses("axes has no 2 numbers of each", [&] {
    list_records(store, "axes", axes, [](auto &a) { return std::tie(a.parameter, a.lower); });
  }));
  Thing thing;
  EXPECT_TRUE(
      refuses("sizes", [&] { list_record(store, "sizes", std::tie(thing.first, thing.second)); }));
  std::map<std::string, double> map;
  EXPECT_TRUE(refuses("heights", [&] { list_map(store, "names", "heights", map); }));
  EXPECT_TRUE(refuses("'mu' is missing", [&] { store("mu", thing.mu); }));
}

} // namespace
} // namespace rbvi::fields_test
