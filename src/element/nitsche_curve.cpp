#include "rbvi/element/nitsche_curve.hpp"

#include <cmath>

namespace rbvi {

namespace {

using Row = NitschePoint::Row;

Row local(const NitscheFace &face, const Vector &u) {
  Row result = Row::Zero();
  for (std::size_t i = 0; i < face.dofs.size(); ++i)
    if (face.dofs[i] >= 0) result[static_cast<Index>(i)] = u[face.dofs[i]];
  return result;
}

/// What the terms depend on at one point.
struct Scalars {
  double sigma_n, sigma_tau, p_n, p_tau;
};

Scalars scalars(const NitscheFace &face, const NitschePoint &point, const Row &u) {
  const double sigma_n = point.sigma_n.dot(u), sigma_tau = point.sigma_tau.dot(u);
  return {sigma_n, sigma_tau, sigma_n - face.gamma * (point.n.dot(u) - point.gap),
          sigma_tau - face.gamma * (point.tau.dot(u) + point.slip)};
}

/// Calls visit(face, point, scalars, bound) at every point; bound < 0 without friction.
template <class Visit>
void at_all_points(const std::vector<NitscheFace> &faces, const Vector &u, const Vector &bounds,
                   const Visit &visit) {
  Index number = 0;
  for (const NitscheFace &face : faces) {
    const Row here = local(face, u);
    for (const NitschePoint &point : face.points) {
      visit(face, point, scalars(face, point, here), bounds.size() > 0 ? bounds[number] : -1);
      ++number;
    }
  }
}

} // namespace

Matrix nitsche_pressures(const std::vector<NitscheFace> &faces, const Vector &u) {
  Matrix result(4 * static_cast<Index>(faces.size()), 2);
  Index number = 0;
  at_all_points(faces, u, {}, [&](const auto &, const auto &, const Scalars &s, double) {
    result.row(number++) << s.p_n, s.p_tau;
  });
  return result;
}

Vector nitsche_bounds(const Matrix &pressures, const NitscheLaw &law) {
  if (law.law == FrictionLaw::none) return {};
  return pressures.col(0).unaryExpr([&](double p) {
    if (law.law == FrictionLaw::coulomb) return coulomb_bound(p, law.value);
    return law.only_in_contact && p >= 0 ? 0.0 : law.value;
  });
}

double nitsche_energy(const std::vector<NitscheFace> &faces, const Vector &u,
                      const Vector &bounds) {
  double energy = 0;
  at_all_points(
      faces, u, bounds,
      [&](const NitscheFace &face, const NitschePoint &point, const Scalars &s, double bound) {
        double density =
            consistency_term(s.sigma_n, face.gamma).energy + contact_term(s.p_n, face.gamma).energy;
        if (bound >= 0)
          density += consistency_term(s.sigma_tau, face.gamma).energy +
                     friction_term(s.p_tau, bound, face.gamma).energy;
        energy += point.weight * density;
      });
  return energy;
}

Vector nitsche_residual(const std::vector<NitscheFace> &faces, const Vector &u,
                        const Vector &bounds) {
  Vector result = Vector::Zero(u.size());
  at_all_points(
      faces, u, bounds,
      [&](const NitscheFace &face, const NitschePoint &point, const Scalars &s, double bound) {
        const double contact = contact_term(s.p_n, face.gamma).slope;
        Row tested = (consistency_term(s.sigma_n, face.gamma).slope + contact) * point.sigma_n -
                     face.gamma * contact * point.n;
        if (bound >= 0) {
          const double friction = friction_term(s.p_tau, bound, face.gamma).slope;
          tested += (consistency_term(s.sigma_tau, face.gamma).slope + friction) * point.sigma_tau -
                    face.gamma * friction * point.tau;
        }
        for (std::size_t i = 0; i < face.dofs.size(); ++i)
          if (face.dofs[i] >= 0)
            result[face.dofs[i]] += point.weight * tested[static_cast<Index>(i)];
      });
  return result;
}

std::vector<Eigen::Matrix<double, 12, 12>> nitsche_tangent(const std::vector<NitscheFace> &faces,
                                                           const Vector &u, const Vector &bounds) {
  using Block = Eigen::Matrix<double, 12, 12>;
  std::vector<Block> blocks;
  blocks.reserve(faces.size());
  const auto add = [](Block &block, double factor, const Row &row) {
    if (factor != 0) block.noalias() += factor * row * row.transpose();
  };
  std::size_t number = 0;
  at_all_points(
      faces, u, bounds,
      [&](const NitscheFace &face, const NitschePoint &point, const Scalars &s, double bound) {
        if (number++ % face.points.size() == 0) blocks.emplace_back(Block::Zero());
        const double gamma = face.gamma, weight = point.weight;
        Block &block = blocks.back();
        add(block, weight * consistency_term(s.sigma_n, gamma).curvature, point.sigma_n);
        add(block, weight * contact_term(s.p_n, gamma).curvature, point.sigma_n - gamma * point.n);
        if (bound < 0) return;
        add(block, weight * consistency_term(s.sigma_tau, gamma).curvature, point.sigma_tau);
        add(block, weight * friction_term(s.p_tau, bound, gamma).curvature,
            point.sigma_tau - gamma * point.tau);
      });
  return blocks;
}

} // namespace rbvi
