// Starts from what is known at other parameters.
#include "rbvi/method/starts.hpp"

#include <gtest/gtest.h>

namespace rbvi::starts_test {
namespace {

ParameterSpace square() {
  return all_free({{"a", "", 0, 1, 0.5}, {"b", "", 0, 10, 5}});
}

TEST(Starts, AreFoundOnceAtTheNearestSample) {
  const ParameterSpace space = square();
  Starts<int> starts(space, Matrix{{0.1, 0.9, 0.5}, {5, 5, 9}});
  int asked = 0;
  const auto at = [&](double a, double b) {
    return starts.nearest_from(FullMu{a, b}, [&](Index k) {
      ++asked;
      if (k == 2) throw failure("no answer");
      return static_cast<int>(10 + k);
    });
  };
  EXPECT_EQ(at(0.2, 6), 10);
  EXPECT_EQ(at(0.8, 5), 11);
  EXPECT_EQ(at(0, 4), 10);
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(at(0.5, 10), 0) << "from rest";
  EXPECT_EQ(at(0.5, 9), 0);
  EXPECT_EQ(asked, 3);
  Starts<int> none(space, Matrix(2, 0));
  EXPECT_EQ(none.nearest_from(FullMu{0, 0}, [](Index) { return 1; }), 0);
}

TEST(Starts, OfSolvesOneAfterAnother) {
  const ParameterSpace space = square();
  Starts<Vector> solved(space);
  const FullMu here{0.5, 5};
  const auto all = [](const Vector &x) { return x; };
  EXPECT_EQ(solved.nearest_added(here), nullptr);
  EXPECT_EQ(solved.fit_added(all, here).size(), 0);
  solved.add(FullMu{0.1, 5}, Vector{{1.0}});
  solved.add(FullMu{0.5, 9}, Vector{{2.0}});
  EXPECT_EQ((*solved.nearest_added(FullMu{0.5, 8}))[0], 2);
  EXPECT_EQ((*solved.nearest_added(FullMu{0, 0}))[0], 1);
  EXPECT_EQ(solved.fit_added(all, FullMu{0.1, 5})[0], 1);
  solved.clear();
  EXPECT_EQ(solved.nearest_added(here), nullptr);
}

TEST(Starts, AreTheLastAnswerWhereTheyAreWarm) {
  const ParameterSpace space = square();
  Starts<int> cold(space), warm(space, {}, true);
  for (Starts<int> *starts : {&cold, &warm}) {
    EXPECT_EQ(starts->at([] { return 1; }), 1);
    starts->keep(2);
  }
  EXPECT_EQ(cold.at([] { return 1; }), 1);
  EXPECT_EQ(warm.at([] { return 1; }), 2);
}

} // namespace
} // namespace rbvi::starts_test
