#include "shapes.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/places.hpp"
#include "rbvi/core/text.hpp"

#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

constexpr double pi = std::numbers::pi;
const Point origin{0, 0, 0};

/// Throws bad_input unless the number of edges is 0, or at least 8 and a multiple.
void check_edges(int edges, int least, int multiple) {
  if (edges == 0 || (edges >= least && edges % multiple == 0)) return;
  throw bad_input("edges is " + std::to_string(edges) + ": it must be " +
                  (multiple == 1 ? "" : "a multiple of " + std::to_string(multiple) + ", ") +
                  "at least " + std::to_string(least) + ", or 0");
}

Shape square_with_disc(const ShapeNumbers &numbers) {
  constexpr double radius = 0.2;
  check_edges(numbers.edges, 12, 12);
  const Place square = box({-0.5, -0.5, 0}, {0.5, 0.5, 0});
  MeshRecipe recipe{"square_with_disc", {"obstacle"}, {"boundary"}, numbers.edges};
  recipe.facts = {{"", "the square of side 1 about the origin", square, 1},
                  {"obstacle", "the disk of radius 0.2 about the origin", disk(origin, radius),
                   pi * radius * radius},
                  {"boundary", "all four sides of the square", rim(square), 4}};
  return {recipe, {{"obstacle", {{origin, radius}}}}};
}

Shape half_disc(const ShapeNumbers &numbers) {
  constexpr double down = -pi / 2, core_radius = 0.6;
  if (numbers.angle != 22.5 && numbers.angle != 45)
    throw bad_input("angle is " + short_number(numbers.angle) + ": it must be 22.5 or 45");
  check_edges(numbers.edges, 8, 2);
  const double half_angle = numbers.angle * pi / 180;
  MeshRecipe recipe{numbers.angle == 45 ? "wide_half_disc" : "half_disc",
                    {"core"},
                    {"top", "contact", "arc"},
                    numbers.edges};
  recipe.facts = {
      {"", "the half y <= 0 of the disk of radius 1 about the origin",
       common_part(disk(origin, 1), box({-1, -1, 0}, {1, 0, 0})), pi / 2},
      {"core", "the half disk of radius 0.6 about the origin", disk(origin, core_radius),
       pi / 2 * core_radius * core_radius},
      {"top", "the flat side y = 0", segment({-1, 0, 0}, {1, 0, 0}), 2},
      {"contact",
       "the arc of radius 1 within " + short_number(numbers.angle) + " degrees of (0, -1)",
       arc(origin, 1, down, half_angle), 2 * half_angle, "arc"},
      {"arc", "the whole half circle of radius 1, 'contact' included", arc(origin, 1, down, pi / 2),
       pi}};
  recipe.inclusion = {"core", origin, core_radius};
  const std::vector<Circle> circle{{origin, 1}};
  return {recipe, {{"arc", circle}, {"contact", circle}}};
}

Shape annulus(const ShapeNumbers &numbers) {
  constexpr double hub = 0.3; // in the mesh a polygon with its vertices on the circle
  check_edges(numbers.edges, 8, 1);
  const Place outside = [](const Point &x) { return hub - std::hypot(x[0], x[1]); };
  MeshRecipe recipe{"annulus", {}, {"hub", "rim", "top", "bottom"}, numbers.edges};
  recipe.facts = {
      {"", "the disk of radius 1 about the origin, without its hub",
       common_part(disk(origin, 1), outside), pi * (1 - 0.9 * hub * hub)},
      {"hub", "the circle of radius 0.3 about the origin", arc(origin, hub, 0, pi), 2 * pi * hub},
      {"rim", "the circle of radius 1 about the origin", arc(origin, 1, 0, pi), 2 * pi},
      {"top", "the arc of radius 1 within 45 degrees of (0, 1)", arc(origin, 1, pi / 2, pi / 4),
       pi / 2, "rim"},
      {"bottom", "the arc of radius 1 within 45 degrees of (0, -1)",
       arc(origin, 1, -pi / 2, pi / 4), pi / 2, "rim"}};
  const std::vector<Circle> outer{{origin, 1}};
  return {recipe,
          {{"hub", {{origin, hub, true}}}, {"rim", outer}, {"top", outer}, {"bottom", outer}}};
}

constexpr double middle_height = 1.5; ///< of two_quarter_discs

/// Facts of one body: `up` is 1 for the upper one, -1 for the lower one.
std::vector<MeshFact> quarter_facts(double up) {
  constexpr double quarter = pi / 4;
  const bool upper = up > 0;
  const std::string region = upper ? "upper" : "lower", height = upper ? "1.5" : "-1.5";
  const std::string disk_name = "the disk of radius 1 about (0, " + height + ")";
  const Point middle{0, up * middle_height, 0};
  const Place square = upper ? box({0, middle_height - 1, 0}, {1, middle_height, 0})
                             : box({0, -middle_height, 0}, {1, 1 - middle_height, 0});
  return {
      {region,
       "the quarter x >= 0, y " + std::string(upper ? "<= " : ">= ") + height + " of " + disk_name,
       common_part(disk(middle, 1), square), quarter},
      {upper ? "top" : "bottom", "the flat side y = " + height + ", 0 <= x <= 1",
       segment(middle, {1, up * middle_height, 0}), 1},
      {upper ? "slave" : "master",
       "the arc of '" + region + "' from the axis to 45 degrees beside it",
       arc(middle, 1, -up * 1.5 * quarter, quarter / 2), quarter, "arc"}};
}

Shape two_quarter_discs(const ShapeNumbers &numbers) {
  constexpr double quarter = pi / 4;
  check_edges(numbers.edges, 8, 1);
  const Point up{0, middle_height, 0}, down{0, -middle_height, 0};
  MeshRecipe recipe{numbers.edges == 0 ? "two_quarter_discs" : "two_graded_quarter_discs",
                    {"upper", "lower"},
                    {"axis", "top", "bottom", "slave", "master", "arc"},
                    numbers.edges};
  std::vector<MeshFact> &facts = recipe.facts = quarter_facts(1);
  for (MeshFact &fact : quarter_facts(-1))
    facts.push_back(std::move(fact));
  const Place bodies = nearest({facts[0].distance, facts[3].distance});
  facts.insert(facts.begin(), {"", "two quarter disks, 1 apart", bodies, 2 * quarter});
  facts.push_back(
      {"axis", "the sides x = 0 of both bodies",
       nearest({segment(up, {0, middle_height - 1, 0}), segment(down, {0, 1 - middle_height, 0})}),
       2});
  facts.push_back({"arc", "the round sides of both bodies, 'slave' and 'master' included",
                   nearest({arc(up, 1, -quarter, quarter), arc(down, 1, quarter, quarter)}),
                   4 * quarter});
  return {recipe, {{"slave", {{up, 1}}}, {"master", {{down, 1}}}, {"arc", {{up, 1}, {down, 1}}}}};
}

constexpr double apart = 0.25; ///< two_blocks: each block from y = 0
constexpr double height = 0.5;

/// From (0, y) to (1, y).
Place level(double y) {
  return segment({0, y, 0}, {1, y, 0});
}

/// The sides x = 0 and x = 1 from y = low on.
Place two_sides(double low) {
  return nearest(
      {segment({0, low, 0}, {0, low + height, 0}), segment({1, low, 0}, {1, low + height, 0})});
}

Shape two_blocks() {
  const double high = apart + height;
  const Place upper = box({0, apart, 0}, {1, high, 0}), lower = box({0, -high, 0}, {1, -apart, 0});
  MeshRecipe recipe{
      "two_blocks", {"upper", "lower"}, {"sides", "top", "bottom", "slave", "master"}};
  recipe.facts = {{"", "two blocks, 1 wide and 0.5 high", nearest({upper, lower}), 1},
                  {"upper", "the block [0, 1] x [0.25, 0.75]", upper, 0.5},
                  {"lower", "the block [0, 1] x [-0.75, -0.25]", lower, 0.5},
                  {"sides", "the sides x = 0 and x = 1 of both blocks",
                   nearest({two_sides(apart), two_sides(-high)}), 2},
                  {"top", "the side y = 0.75 of the upper block", level(high), 1},
                  {"bottom", "the side y = -0.75 of the lower block", level(-high), 1},
                  {"slave", "the side y = 0.25 of the upper block", level(apart), 1},
                  {"master", "the side y = -0.25 of the lower block", level(-apart), 1}};
  return {recipe};
}

Shape one_block() {
  MeshRecipe recipe{"one_block", {}, {"sides", "top", "contact"}};
  recipe.facts = {{"", "the block [0, 1] x [0, 0.5]", box({0, 0, 0}, {1, height, 0}), 0.5},
                  {"sides", "the sides x = 0 and x = 1", two_sides(0), 1},
                  {"top", "the side y = 0.5", level(height), 1},
                  {"contact", "the side y = 0", level(0), 1}};
  return {recipe};
}

} // namespace

const std::vector<std::string> &shape_names() {
  static const std::vector<std::string> names{"square_with_disc",  "half_disc",  "annulus",
                                              "two_quarter_discs", "two_blocks", "one_block"};
  return names;
}

Shape shape_of(const std::string &name, const ShapeNumbers &numbers) {
  if (name == "square_with_disc") return square_with_disc(numbers);
  if (name == "half_disc") return half_disc(numbers);
  if (name == "annulus") return annulus(numbers);
  if (name == "two_quarter_discs") return two_quarter_discs(numbers);
  if (name != "two_blocks" && name != "one_block")
    throw bad_input("there is no built-in mesh '" + name + "': use one of " +
                    joined(shape_names()));
  if (numbers.edges != 0) throw bad_input("the number of edges of " + name + " is fixed");
  return name == "two_blocks" ? two_blocks() : one_block();
}

} // namespace rbvi
