#include "motion_text.hpp"

#include "rbvi/core/text.hpp"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace rbvi {

std::string vector_text(int dim, const Point &x) {
  std::string text;
  for (int c = 0; c < dim; ++c)
    text.append(c == 0 ? "(" : ", ").append(short_number(std::abs(x[c]) < 1e-9 ? 0 : x[c]));
  return text.append(")");
}

namespace {

constexpr std::size_t most_told = 3; ///< bodies

/// Of either sign.
std::string direction_text(int dim, const Point &x) {
  const double sign = *std::ranges::max_element(x, {}, [](double part) { return std::abs(part); });
  return vector_text(dim, x / std::copysign(1, sign));
}

/// "along (0, 1)": directions, the columns, orthonormal.
std::string translations_text(int dim, const Matrix &directions) {
  if (directions.cols() == dim) return "move in every direction";
  const auto column = [&](Index j) {
    Point direction{};
    for (Index c = 0; c < dim; ++c)
      direction[c] = directions(c, j);
    return direction;
  };
  const bool one = directions.cols() == 1;
  return (one ? "move along " : "move at right angles to ") +
         direction_text(dim, one ? column(0) : cross(column(0), column(1)));
}

/// Of turns, the columns: about a point in the plane, about an axis in space.
std::string turn_text(int dim, const MeshPart &body, const Matrix &turns) {
  if (dim == 3)
    return turns.cols() > 1 ? "turn"
                            : "turn about an axis along " +
                                  direction_text(dim, {turns(4, 0), turns(5, 0), turns(3, 0)});
  // The velocity (t_x - w y, t_y + w x) at (x, y) from the centre, in sizes, is zero there.
  const double scale = body.size() / turns(2, 0);
  return "turn about " +
         vector_text(dim, body.centre() + Point{-turns(1, 0) * scale, turns(0, 0) * scale, 0});
}

} // namespace

std::string motions_text(int dim, const MeshPart &body, const Matrix &free) {
  if (free.cols() == free.rows()) return free.cols() == 1 ? "move" : "move and turn";
  // Combinations without a turn are the translations, those at right angles to them turn.
  const Eigen::JacobiSVD<Matrix> svd(free.bottomRows(free.rows() - dim), Eigen::ComputeFullV);
  const auto turning = (svd.singularValues().array() > std::sqrt(motion_is_held)).count();
  const Matrix all = free * svd.matrixV();
  std::vector<std::string> texts;
  if (free.cols() > turning)
    texts.push_back(translations_text(dim, all.topRightCorner(dim, free.cols() - turning)));
  if (turning > 0) texts.push_back(turn_text(dim, body, all.leftCols(turning)));
  return joined(texts, " and ");
}

std::string describe(const std::vector<FreeBody> &bodies, int dim, const Matrix &motions) {
  std::string text;
  std::size_t told = 0;
  Index first = 0;
  for (const FreeBody &body : bodies) {
    const Index count = body.motions.cols();
    const Eigen::JacobiSVD<Matrix> svd(motions.middleRows(first, count), Eigen::ComputeThinU);
    const Matrix own =
        svd.matrixU().leftCols((svd.singularValues().array() > 1e-6 * motions.norm()).count());
    first += count;
    if (own.cols() == 0 || ++told > most_told) continue;
    text.append(told == 1 ? "" : ", ")
        .append(
            body.name + " can " +
            (body.turned ? "move along (0, 1)" : motions_text(dim, body.part, body.motions * own)));
  }
  if (told > most_told) text.append(" (and " + std::to_string(told - most_told) + " more)");
  return text;
}

} // namespace rbvi
