#include "rbvi/model/certificate.hpp"

#include "basis_change.hpp"
#include "rbvi/method/certificate.hpp"
#include "rbvi/model/affine_coefficients.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

/// Adds factor * sum of theta_q (block q of `terms`) x to the first entries of `result`, of few
/// entries of x that are not zero.
void add_terms(const Matrix &terms, const Vector &theta, const Vector &x, double factor,
               Vector &result) {
  for (Index q = 0; q < theta.size(); ++q)
    for (Index k = 0; k < x.size(); ++k)
      if (x[k] != 0)
        result.head(terms.rows()) += factor * theta[q] * x[k] * terms.col(q * x.size() + k);
}

/// What the condition leaves at the answer, and what of it is round-off.
struct Gaps {
  ContactOperators at_mu;
  Vector left;     ///< B u_N - g
  double roundoff; ///< of an entry
};

Gaps gaps_of(const ReducedModel &model, const Contact &contact, const ReducedAnswer &answer) {
  constexpr double units = 64 * std::numeric_limits<double>::epsilon();
  Gaps gaps;
  if (answer.contact.b.rows() > 0)
    gaps.at_mu = answer.contact;
  else
    assemble(contact, answer.mu, {}, gaps.at_mu);
  const Vector u = model.contact.trace * answer.u;
  gaps.left = gaps.at_mu.b * u - gaps.at_mu.g;
  double largest = gaps.at_mu.g.cwiseAbs().maxCoeff();
  for (Index row = 0; row < gaps.at_mu.b.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(gaps.at_mu.b, row); entry; ++entry)
      largest = std::max(largest, std::abs(entry.value() * u[entry.col()]));
  gaps.roundoff = units * largest;
  return gaps;
}

/// Sum of k |v_t| - x_t . v_t over the nodes with friction, `slip` v_t at all rows.
double friction_slack(const NodeLaws &laws, const Vector &x, const Vector &slip) {
  double sum = 0;
  for (Index node = 0; node < laws.nodes(); ++node) {
    if (!laws.has_tangent(node)) continue;
    const auto of = [&](const Vector &rows) {
      return rows.segment(laws.tangent[node], laws.tangents);
    };
    const double k = laws.bound[node].value(x[laws.normal[node]]);
    sum += std::max(0.0, k * of(slip).norm() - of(x).dot(of(slip)));
  }
  return sum;
}

/// Norms of r - A z and of r + A z in A(mu)^-1, r . z and z . A z; `u` and `z` coefficients of the
/// primal basis and of the lifting functions, `pushed` B^T l at CertificateModel::dofs.
struct Residual {
  double minus, plus, work = 0, square = 0;
};
Residual residual_of(const CertificateModel &certificate, const Vector &theta_a,
                     const Vector &theta_f, const Vector &pushed, const Vector &u,
                     const Vector &z) {
  const Index count = std::ssize(certificate.references);
  Matrix references(theta_a.size(), count);
  Vector minus(count), plus(count);
  Residual result{};
  for (Index j = 0; j < count; ++j) {
    const CertificateReference &at = certificate.references[j];
    references.col(j) = at.theta;
    Vector residual = Vector::Zero(at.of_loads.rows()), lifted = residual;
    add_terms(at.of_basis, theta_a, u, -1, residual);
    add_terms(at.of_contact, Vector::Ones(1), pushed, -1, residual);
    add_terms(at.of_loads, Vector::Ones(1), theta_f, 1, residual);
    add_terms(at.of_lifting, theta_a, z, 1, lifted);
    minus[j] = (residual - lifted).norm();
    plus[j] = (residual + lifted).norm();
    if (j > 0) continue;
    Vector own = Vector::Zero(at.of_lifting.rows()); // coordinates of z
    add_terms(at.of_lifting, at.theta, z, 1, own);
    result.work = residual.head(own.size()).dot(own);
    result.square = lifted.head(own.size()).dot(own);
  }
  result.minus = norm_over_references(references, theta_a, minus);
  result.plus = norm_over_references(references, theta_a, plus);
  return result;
}

/// B of lifting functions, each made once.
ColumnSource pushes_of(const Matrix &functions, const SparseMatrix &b) {
  return [&, made = std::vector<bool>(functions.cols(), false),
          all = Matrix(b.rows(), functions.cols())](const std::vector<Index> &which) mutable {
    for (const Index function : which) {
      if (made[function]) continue;
      made[function] = true;
      all.col(function) = b * functions.col(function);
    }
    return Matrix(all(Eigen::all, which));
  };
}

/// z . A z of the lifting functions.
double square_of(const CertificateModel &certificate, const Vector &theta_a, const Vector &z) {
  const CertificateReference &at = certificate.references.front();
  Vector own = Vector::Zero(at.of_lifting.rows()), lifted = own;
  add_terms(at.of_lifting, at.theta, z, 1, own);
  add_terms(at.of_lifting, theta_a, z, 1, lifted);
  return own.dot(lifted);
}

/// At the columns of B, 1 where the nodes of the first boundary move along y.
Vector upwards(const InterfaceMesh &mesh) {
  Vector nodal = Vector::Zero(std::ssize(mesh.dofs));
  for (int node = 0; node < mesh.parts.front() && mesh.components > 1; ++node)
    nodal[node * mesh.components + 1] = 1;
  return at_columns(mesh, nodal);
}

/// Of the normal multipliers: their integral, and what they push the first body by along y.
struct Forces {
  Matrix of;                    ///< nodes x 2
  std::array<double, 2> pull{}; ///< of adhesion, beside them
};
Forces forces_of(const Contact &contact, const FullMu &mu, const ContactOperators &at_mu,
                 const NodeLaws &laws) {
  Forces forces;
  Vector pushes = Vector::Zero(at_mu.b.rows());
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    ContactInterface &interface = *contact.interfaces[i];
    const Index first = contact.first_row[i], count = interface.dual().size();
    pushes.segment(first, count) = -(at_mu.b.middleRows(first, count) * upwards(interface.mesh()));
    const Pull pull = pull_of(interface, mu, {});
    forces.pull[0] += pull.normal_force;
    forces.pull[1] += pull.force[1];
  }
  forces.of.resize(std::ssize(laws.normal), 2);
  forces.of << at_mu.weights, pushes(laws.normal);
  return forces;
}

/// `x`: normal multipliers; `linear`: of both forces.
void add_forces(const CertificateModel &certificate, const Vector &theta_a,
                const std::vector<LinearOutput> &linear, const Forces &forces, const Vector &x,
                const ErrorBound &bound, AnswerBound &result) {
  constexpr double units = 64 * std::numeric_limits<double>::epsilon();
  const auto of = [&](std::size_t k) {
    const auto force = forces.of.col(static_cast<Index>(k));
    const double value = force.dot(x) + forces.pull[k],
                 norm = std::sqrt(square_of(certificate, theta_a, linear[k].weights)),
                 off = norm * bound.multiplier + linear[k].far * bound.gap +
                       units * (force.cwiseAbs().dot(x) + std::abs(forces.pull[k]));
    return AnswerBound::Interval{value - off, value + off};
  };
  result.normal_force = of(0);
  result.reaction = of(1);
}

/// Whether the bounds of friction are known before the answer is.
bool are_given(const NodeLaws &laws) {
  for (Index node = 0; node < laws.nodes(); ++node)
    if (const FrictionBound &bound = laws.bound[node];
        laws.has_tangent(node) && bound.acts() && bound.follows_pressure())
      return false;
  return true;
}

/// Of the least energy, which is at most `gap` below `upper`. `terms`: the sum of the sizes of what
/// is added up.
AnswerBound::Interval interval(double upper, double gap, double terms) {
  constexpr double units = 64 * std::numeric_limits<double>::epsilon();
  return {upper - gap - units * terms, upper + units * terms};
}

/// The load's coefficients at mu; empty: there is none.
Vector load_coefficients(const ReducedModel &model, const Scene &scene, const FullMu &mu) {
  return model.body.f.size() > 0 ? affine_coefficients(model.body.f, scene.f, scene, mu) : Vector();
}

} // namespace

std::optional<AnswerBound> bound_of(const ReducedModel &model, const Scene &scene,
                                    const Contact &contact, const ReducedAnswer &answer,
                                    const Vector &lambda, double imposed_energy, bool forces) {
  const CertificateModel &certificate = model.certificate;
  if (certificate.references.empty()) return std::nullopt;
  const NodeLaws laws = laws_at(contact, answer.mu);
  const Vector x = admissible(laws, lambda);
  const Gaps gaps = gaps_of(model, contact, answer);
  const SparseMatrix &b = gaps.at_mu.b;

  Vector pushed = b.transpose() * x;
  const Vector known = pushed(certificate.dofs);
  pushed(certificate.dofs).setZero();
  if ((pushed.array() != 0).any()) return std::nullopt;

  const std::vector<int> &own = certificate.own;
  const Matrix &functions = certificate.lifting_trace;
  const ColumnSource lifted = pushes_of(functions, b);
  const std::optional<Lifting> lifting =
      lift(lifted, functions.cols(), own, gaps.left, x, laws, gaps.roundoff);
  if (!lifting) return std::nullopt;
  const Vector &z = lifting->weights;

  const Vector theta_a = affine_coefficients(model.body.a, scene.a, scene, answer.mu);
  const Vector theta_f = load_coefficients(model, scene, answer.mu);
  const Residual residual = residual_of(certificate, theta_a, theta_f, known, answer.u, z);
  double slack = x(laws.normal).dot(lifting->left(laws.normal));
  if (laws.has_tangents()) slack += friction_slack(laws, x, -lifting->left);
  const ErrorBound bound = error_bound(residual.minus, residual.plus, slack);
  if (!std::isfinite(bound.u)) return std::nullopt; // A is no sum of those at the references

  const double square = energy_product(model, theta_a, answer.u);
  AnswerBound result{std::max(bound.u, bound.multiplier), std::sqrt(square), are_given(laws)};
  if (laws.has_tangents()) return result;
  // J(v) = J(u_N) + (r + B^T l_N) . z + z . A z / 2
  const double work = theta_f.size() > 0 ? answer.u.dot(model.body.f.reduced * theta_f) : 0.0,
               pushing = x.dot(b * Vector(functions * z));
  result.energy =
      interval(imposed_energy + square / 2 - work + residual.work + pushing + residual.square / 2,
               bound.gap, std::abs(imposed_energy) + square + std::abs(work) + std::abs(pushing));
  if (!forces) return result;
  const Forces both = forces_of(contact, answer.mu, gaps.at_mu, laws);
  if (const auto linear = linear_outputs(lifted, functions.cols(), own, x, lifting->left, both.of))
    add_forces(certificate, theta_a, *linear, both, x, bound, result);
  return result;
}

/// With u_x the body's displacement under f and l_N, z = u_N - u_x and v = u_x, r + A z = 0 but for
/// what the basis leaves of A^-1 f.
AnswerBound bound_by_law(const ReducedModel &model, const Scene &scene, const NodeLaws &laws,
                         const ReducedAnswer &answer, double imposed_energy) {
  constexpr double units = 16 * std::numeric_limits<double>::epsilon();
  const Vector theta_f = load_coefficients(model, scene, answer.mu);
  const double square =
      energy_product(model, affine_coefficients(model.body.a, scene.a, scene, answer.mu), answer.u);
  double work = 0, alone = 0, outside = 0; // of the load
  if (theta_f.size() > 0) {
    const double root = std::sqrt(common_coefficient(scene.a, scene.parameters, answer.mu));
    work = answer.u.dot(model.body.f.reduced * theta_f);
    alone = (model.certificate.of_loads * theta_f).squaredNorm() / (root * root);
    outside = (model.certificate.left_of_loads * theta_f).norm() / root;
  }
  const double of_law = answer.energy - imposed_energy;
  const double apart =
      std::max(0.0, 2 * of_law - (square - 2 * work)) +
      units * (std::abs(answer.energy) + std::abs(imposed_energy) + square + alone);
  double slack = 0;
  const Vector &x = answer.lambda, &w = answer.left;
  for (const Index row : laws.normal)
    slack += x[row] * std::max(0.0, w[row]);
  if (laws.has_tangents()) slack += friction_slack(laws, x, -w);
  const ErrorBound bound = error_bound(outside + 2 * std::sqrt(apart), outside, slack);
  AnswerBound result{std::max(bound.u, bound.multiplier), std::sqrt(square), are_given(laws)};
  if (laws.has_tangents()) return result;
  // Of the load that the basis leaves, what multipliers work on its displacement: |B^T l|^2 is
  // 2 E + |f|^2.
  const double unknown = outside * std::sqrt(std::max(0.0, 2 * of_law + alone));
  result.energy = interval(answer.energy + unknown, bound.gap + 2 * unknown,
                           std::abs(answer.energy) + std::abs(imposed_energy) + square + alone);
  return result;
}

void change_certificate(const BasisChange &to, CertificateModel &certificate) {
  if (to.loses()) certificate.by_law = false;
  for (CertificateReference &reference : certificate.references)
    reference.of_basis = to.side_by_side(reference.of_basis);
}

} // namespace rbvi
