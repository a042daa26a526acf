// Functions of a scene that are written as expressions.
#pragma once

#include "rbvi/core/expression.hpp"
#include "rbvi/core/functions.hpp"

namespace rbvi {

/// An expression with a name, which others use.
struct Let {
  std::string name;
  Expression value;
};

/// Expressions of one point. They have the names of parameters, of `lets`, each evaluated once a
/// point, and those of coordinates: x, y, z of the point, and in a traction nx, ny, nz of a unit
/// normal.
struct Formula {
  std::vector<Expression> values;
  std::vector<Let> lets{};               ///< each may use those before it
  std::vector<std::string> parameters{}; ///< in the order of FullMu
};

/// Throws bad_input for names that are none of these.
std::function<Coefficient> coefficient_of(const Formula &value);
std::function<PointValue> point_value_of(const Formula &value);
/// Components that are left out are 0.
std::function<PointMap> point_map_of(const Formula &components);
std::function<Traction> traction_of(const Formula &components);
/// A value and its derivatives by x and y.
std::function<PointMap> value_and_gradient_of(const Formula &value);
/// Its derivatives by x, y and z.
std::function<PointMap> gradient_of(const Formula &value);
/// What outputs may name beside parameters, in the order of output_fields(); what there is not at
/// some place is NaN there. x, y, z: where the map takes the point; ux, uy, uz, of a membrane u:
/// the displacement, with the motion; of contact pressure, gap, tangential stress, slip (in space
/// the sizes of both) and whether there is contact, and stick; on boundaries the normal outwards;
/// of the body stresses and the elastic energy of a volume.
namespace field {
enum : std::size_t {
  x,
  y,
  z,
  ux,
  uy,
  uz,
  pressure,
  gap,
  tangential,
  slip,
  u,
  nx,
  ny,
  nz,
  sigma_xx,
  sigma_yy,
  sigma_zz,
  sigma_xy,
  sigma_yz,
  sigma_xz,
  von_mises,
  strain_energy,
  contact,
  stick,
  slope_x, ///< of a membrane, du/dx
  slope_y,
  count
};
}
using OutputFields = std::array<double, field::count>;
const std::vector<std::string> &output_fields();
/// Two values in them: of an output, and whether it is asked for there (not 0).
std::function<FieldValues> field_values_of(const Formula &values);
/// Throws bad_input with the message of the first of these conditions that is 0 or NaN;
/// {expression} in it becomes the value.
std::function<Check> check_of(const Formula &conditions, const std::vector<std::string> &messages);

/// map(mu, x) of many points: those of an expression are evaluated together, in less time.
std::vector<Point> images(const std::function<PointMap> &map, const FullMu &mu,
                          const std::vector<Point> &points);

/// With every let written out.
Expression expanded(const Expression &expression, const std::vector<Let> &lets);

/// Positions of the parameters that the values depend on, increasing.
std::vector<int> dependence_of(const Formula &formula);
/// Whether the values depend on the point or the normal.
bool depends_on_point(const Formula &formula);
/// Whether a name is one of those of coordinates.
bool is_coordinate(const std::string &name);

} // namespace rbvi
