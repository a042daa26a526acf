// The outputs of Nitsche's method for pressures that are prescribed along a straight curve and
// along an arc.
#include "curves.hpp"
#include "rbvi/contact/nitsche_curve.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace rbvi::nitsche_outputs_test {
namespace {

constexpr NitscheLaw frictionless{};
constexpr NitscheLaw coulomb = FrictionBound{0.3, 0, false};

/// Faces of a body above a curve, of degree 1, as far as outputs look at them: weights and
/// directions.
std::vector<NitscheFace> faces_on(const Curve &curve) {
  std::vector<NitscheFace> faces;
  for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
    const double edge = length(curve, static_cast<Index>(k));
    const double n[] = {(curve[k + 1][1] - curve[k][1]) / edge,
                        (curve[k][0] - curve[k + 1][0]) / edge};
    NitscheFace face{};
    for (NitschePoint &point : face.points) {
      point.weight = edge / 4;
      point.body_normal = point.facing.normal = {n[0], n[1], 0};
      point.n.setZero();
      point.tau.setZero();
      for (Index i = 0; i < 6; ++i) { // each node has a third
        point.n[i] = n[i % 2] / 3;
        point.tau[i] = (i % 2 == 0 ? -n[1] : n[0]) / 3;
      }
    }
    faces.push_back(face);
  }
  return faces;
}

/// At the four points of each face: (P_n, P_tau).
Matrix pressures_of(const std::vector<Eigen::RowVector2d> &of_faces) {
  Matrix result(4 * static_cast<Index>(of_faces.size()), 2);
  for (std::size_t k = 0; k < of_faces.size(); ++k)
    result.middleRows<4>(4 * static_cast<Index>(k)).rowwise() = of_faces[k];
  return result;
}

/// Fields of constant pressure p, without tangential stress, that fulfil the law.
CurveFields constant_fields(Index count, double p) {
  CurveFields fields;
  for (Vector *field :
       {&fields.sigma_tau, &fields.p_tau, &fields.excess, &fields.sigma_n, &fields.p_n})
    *field = Vector::Zero(count);
  fields.sigma_n.setConstant(-p);
  fields.p_n.setConstant(-p);
  fields.arc_length = Vector::LinSpaced(count, -0.5, 0.5);
  fields.images = Vector::Ones(count);
  return fields;
}

Outputs outputs_of(std::vector<NitscheFace> faces, const Matrix &pressures,
                   const CurveFields &fields, const NitscheLaw &law) {
  for (NitscheFace &face : faces)
    face.law = law;
  Outputs outputs;
  nitsche_outputs(faces, pressures, nitsche_bounds(faces, pressures), fields, outputs);
  return outputs;
}

const std::vector<NitscheFace> straight = faces_on(line(4, -0.5, 0.5, 0));

/// Three of four edges touch.
TEST(NitscheOutputs, AStraightCurveWithoutFriction) {
  const Matrix pressures = pressures_of({{-2, 7}, {-2, 7}, {-1, 7}, {3, 7}});
  const Outputs o = outputs_of(straight, pressures, constant_fields(5, 2), frictionless);
  EXPECT_NEAR(*o.normal_force, 0.25 * (2 + 2 + 1), 1e-15);
  EXPECT_NEAR(*o.reaction, *o.normal_force, 1e-15);
  EXPECT_NEAR(*o.contact_measure, 0.75, 1e-15);
  EXPECT_NEAR(*o.contact_half_width, 0.375, 1e-15);
  EXPECT_EQ(*o.peak_pressure, 2);
  EXPECT_NEAR(*o.centre_pressure, 1.5, 1e-14) << "between the two edges beside the middle";
  EXPECT_EQ(*o.max_penetration, 0);
  EXPECT_EQ(*o.law_error_normal, 0);
  EXPECT_FALSE(o.tangential_force || o.stick_half_width || o.friction_violation ||
               o.law_error_tangential || o.law_error_tau_over_n);
}

TEST(NitscheOutputs, ABodyThatIsPressedFromInsideIsRefused) {
  std::vector<NitscheFace> faces = straight;
  faces[3].points[2].body_normal[1] *= -1;
  const CurveFields fields = constant_fields(5, 2);
  EXPECT_NO_THROW(
      outputs_of(faces, pressures_of({{-2, 0}, {-2, 0}, {-1, 0}, {3, 0}}), fields, frictionless));
  EXPECT_THROW(
      outputs_of(faces, pressures_of({{-2, 0}, {-2, 0}, {-1, 0}, {-1, 0}}), fields, frictionless),
      Error);
}

/// Bounds 0.6, 0.6, 0.3 and 0: the first edge sticks, the others slip.
TEST(NitscheOutputs, AStraightCurveWithFriction) {
  const Matrix pressures = pressures_of({{-2, 0.1}, {-2, -5}, {-1, 0.4}, {3, 7}});
  const Outputs o = outputs_of(straight, pressures, constant_fields(5, 2), coulomb);
  EXPECT_NEAR(*o.tangential_force, 0.25 * (0.1 + 0.6 + 0.3), 1e-15);
  EXPECT_NEAR(*o.stick_half_width, 0.125, 1e-15);
  EXPECT_NEAR(*o.reaction, *o.normal_force, 1e-15) << "friction is horizontal";
  EXPECT_NEAR(*o.horizontal_reaction, 0.25 * (0.1 - 0.6 + 0.3), 1e-15);
}

/// Without contact Tresca's bound acts all the same, but nothing is said to stick.
TEST(NitscheOutputs, TrescasForceActsBesideTheContact) {
  const Matrix pressures = pressures_of({{3, 5}, {3, 0.1}, {-2, 0.1}, {-2, 5}});
  const NitscheLaw everywhere = FrictionBound{0, 0.4, false};
  const NitscheLaw in_contact = FrictionBound{0, 0.4, true};
  const CurveFields fields = constant_fields(5, 2);
  const Outputs o = outputs_of(straight, pressures, fields, everywhere);
  EXPECT_NEAR(*o.tangential_force, 0.25 * (0.4 + 0.1 + 0.1 + 0.4), 1e-15);
  EXPECT_NEAR(*o.stick_half_width, 0.125, 1e-15);
  EXPECT_NEAR(*outputs_of(straight, pressures, fields, in_contact).tangential_force,
              0.25 * (0.1 + 0.4), 1e-15);
}

/// Vertical forces of a pressure and of a friction that pulls both sides upwards are those of its
/// width and of its height.
TEST(NitscheOutputs, AnArc) {
  Curve arc;
  for (Index i = 0; i <= 6; ++i) {
    const double angle = 0.5 * static_cast<double>(i - 3) / 3;
    arc.push_back({1.1 * std::sin(angle), -1.1 * std::cos(angle), 0});
  }
  const double p = 2, q = 0.1, width = 2.2 * std::sin(0.5), height = 1.1 * (1 - std::cos(0.5));
  const double edges = length(arc);
  const Matrix pressures = pressures_of({{-p, -q}, {-p, -q}, {-p, -q}, {-p, q}, {-p, q}, {-p, q}});
  const Outputs without = outputs_of(faces_on(arc), pressures, constant_fields(7, p), frictionless);
  EXPECT_NEAR(*without.normal_force, p * edges, 1e-14);
  EXPECT_NEAR(*without.contact_half_width, edges / 2, 1e-14);
  EXPECT_NEAR(*without.reaction, p * width, 1e-14);
  const Outputs with = outputs_of(faces_on(arc), pressures, constant_fields(7, p), coulomb);
  EXPECT_NEAR(*with.tangential_force, q * edges, 1e-14);
  EXPECT_NEAR(*with.stick_half_width, edges / 2, 1e-14);
  EXPECT_NEAR(*with.reaction, p * width + 2 * q * height, 1e-14);
}

TEST(NitscheOutputs, NoContactIsAllZero) {
  const Matrix pressures = pressures_of({{1, 0}, {1, 0}, {1, 0}, {1, 0}});
  CurveFields fields = constant_fields(5, 0);
  fields.p_n.setConstant(1);
  fields.excess.setConstant(-0.1);
  const Outputs o = outputs_of(straight, pressures, fields, coulomb);
  for (const auto &value :
       {o.normal_force, o.reaction, o.contact_measure, o.contact_half_width, o.peak_pressure,
        o.centre_pressure, o.max_penetration, o.tangential_force, o.stick_half_width,
        o.friction_violation, o.law_error_normal, o.law_error_tangential, o.law_error_tau_over_n})
    EXPECT_EQ(value.value(), 0);
}

/// One vertex of five pulls, another exceeds its bound.
TEST(NitscheOutputs, ErrorsOfTheLawsAreRelativeNorms) {
  const Matrix pressures = pressures_of({{-2, 0}, {-2, 0}, {-2, 0}, {-2, 0}});
  CurveFields fields = constant_fields(5, 2);
  fields.sigma_n[0] = 1.5; // where P_n is -2
  fields.excess[3] = 0.02;
  fields.sigma_tau[1] = 0.8; // the bound is 0.6, and P_tau beyond it
  fields.p_tau[1] = 4;
  const Outputs o = outputs_of(straight, pressures, fields, coulomb);
  const double normal = std::sqrt(4 * 4 + 1.5 * 1.5);
  EXPECT_NEAR(*o.law_error_normal, 3.5 / normal, 1e-15);
  EXPECT_NEAR(*o.law_error_tangential, 0.2 / 0.8, 1e-15);
  EXPECT_NEAR(*o.law_error_tau_over_n, 0.2 / normal, 1e-15);
  EXPECT_NEAR(*o.friction_violation, 0.2, 1e-15);
  EXPECT_EQ(*o.max_penetration, 0.02);
}

} // namespace
} // namespace rbvi::nitsche_outputs_test
