#include "rbvi/study/errors.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/model/packed.hpp"
#include "rbvi/mor/cones.hpp"
#include "rbvi/mor/stability.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>

namespace rbvi {

namespace {

/// <x, y>_V for natural fields given as free vectors.
double product(Mat v, Vec x, Vec y, Vec scratch) {
  PetscScalar value = 0;
  RBVI_CALL(MatMult(v, y, scratch));
  RBVI_CALL(VecDot(x, scratch, &value));
  return value;
}

/// 1 at the rows of normal multipliers, 0 at those of tangential ones.
Vector normal_rows(const Contact &contact) {
  Vector rows(contact.dual_size());
  for (Index row = 0; row < rows.size(); ++row)
    rows[row] = dual_row(contact, row).normal ? 1 : 0;
  return rows;
}

/// |values|_W of the normal multipliers, and of the tangential ones.
struct PartNorms {
  double normal, tangential;
};
PartNorms part_norms(const SparseMatrix &w, const Vector &values, const Vector &normal_rows) {
  const Vector normal = values.cwiseProduct(normal_rows), tangential = values - normal;
  return {std::sqrt(normal.dot(w * normal)), std::sqrt(tangential.dot(w * tangential))};
}

/// Adds, for Nitsche's method, errors of the stresses of the projected displacement.
void add_stress_floors(const ReducedModel &model, const Matrix &projections, const Truths &truths,
                       const SparseMatrix &w, ModelErrors &errors) {
  OnlineSolver solver(model);
  const Vector normal = normal_rows(solver.contact());
  const Index count = projections.cols();
  errors.lambda_floor.resize(count);
  errors.tangential_floor.resize(truths.tangential_norm.size());
  for (Index p = 0; p < count; ++p) {
    ReducedAnswer projected;
    projected.mu = expand(model.scene.parameters, truths.mu[p]);
    projected.u = projections.col(p);
    const Vector difference = solver.multiplier(projected) - truths.lambda.col(p);
    const PartNorms norms = part_norms(w, difference, normal);
    errors.lambda_floor[p] = relative(norms.normal, truths.lambda_norm[p], truths.largest_lambda);
    if (errors.tangential_floor.size() > 0)
      errors.tangential_floor[p] =
          relative(norms.tangential, truths.tangential_norm[p], truths.largest_tangential);
  }
}

/// Relative distances of the true multipliers to what the dual basis spans.
Vector multiplier_floor(const ReducedModel &model, const Truths &truths, const SparseMatrix &w) {
  if (model.contact.law) return Vector::Zero(truths.lambda_norm.size());
  const Index bounded = model.contact.generators - model.contact.free_modes;
  const Vector distance =
      distances_to_cone(truths.lambda, {model.contact.dual_basis.leftCols(bounded)}, w,
                        {model.contact.dual_basis.rightCols(model.contact.free_modes)}) *
      truths.lambda_norm.maxCoeff();
  return distance.binaryExpr(truths.lambda_norm, [&](double d, double size) {
    return relative(d, size, truths.largest_lambda);
  });
}

/// The answer at one validation mu, nothing if the model has none.
std::optional<ReducedAnswer> answer_at(OnlineSolver &solver, const Truths &truths, Index p) {
  try {
    return solver.solve(truths.mu[p], true);
  } catch (const Error &) {
    return std::nullopt;
  }
}

} // namespace

double relative(double error, double size, double largest) {
  constexpr double least_share = 1e-2;
  const double scale = std::max(size, least_share * largest);
  return scale > 0 ? error / scale : error;
}

void share_scale(Truths &one, Truths &other) {
  for (const auto member :
       {&Truths::largest_u, &Truths::largest_lambda, &Truths::largest_tangential})
    one.*member = other.*member = std::max(one.*member, other.*member);
}

double displacement_norm(Problem &problem, const Mu &mu, const Vector &u) {
  const Scene &scene = problem.scene();
  const Mesh &mesh = problem.mesh();
  const FullMu all = expand(scene.parameters, mu);
  const auto count = static_cast<std::size_t>(scene.components);
  Vector whole(std::ssize(mesh.points) * scene.components);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const Point motion = scene.motion ? scene.motion(all, mesh.points[v]) : Point{};
    for (std::size_t c = 0; c < count; ++c)
      whole[v * count + c] =
          motion[c] + u[mesh.natural_node[v] * scene.components + static_cast<Index>(c)];
  }
  double square =
      whole.dot(product_with(forms_of(scene.v_product), {}, mesh, problem.dofs(), {}, whole));
  MPI_Allreduce(MPI_IN_PLACE, &square, 1, MPI_DOUBLE, MPI_SUM, problem.comm());
  return std::sqrt(square);
}

Truths make_truths(Problem &problem, const ReducedModel &model,
                   const std::vector<Sample> &samples) {
  const Index n = model.primal_size(), count = std::ssize(samples);
  if (model.fields.basis.rows() != problem.dofs().total)
    throw failure("errors of the displacement need the fields of the model");
  Mat v = problem.v_product();
  std::vector<Handle<Vec>> basis;
  std::vector<Vec> raw;
  for (Index j = 0; j < n; ++j) {
    basis.push_back(from_natural(problem.dofs(), model.fields.basis.col(j)));
    raw.push_back(basis.back().get());
  }
  const Handle<Vec> scratch = make_vector(problem.dofs());
  Truths truths{{},
                Matrix(n, count),
                Vector(count),
                Vector(count),
                Matrix(model.contact.dual_basis.rows(), count),
                Vector(count),
                {},
                {}};
  const Vector normal = normal_rows(problem.contact());
  if (has_friction(problem.scene())) truths.tangential_norm.resize(count);
  for (Index p = 0; p < count; ++p) {
    const Sample &sample = samples[p];
    const Handle<Vec> u = from_natural(problem.dofs(), sample.u);
    truths.u_norm[p] = displacement_norm(problem, sample.mu, sample.u);
    RBVI_CALL(MatMult(v, u.get(), scratch.get()));
    RBVI_CALL(VecMDot(scratch.get(), static_cast<PetscInt>(n), raw.data(),
                      truths.coordinates.col(p).data()));
    const Vector back = -truths.coordinates.col(p);
    RBVI_CALL(VecMAXPY(u.get(), static_cast<PetscInt>(n), back.data(), raw.data()));
    truths.remainder[p] = std::sqrt(std::max(0.0, product(v, u.get(), u.get(), scratch.get())));
    truths.mu.push_back(sample.mu);
    truths.outputs.push_back(sample.outputs);
    truths.lambda.col(p) = sample.lambda;
    const PartNorms norms = part_norms(problem.w_product(), sample.lambda, normal);
    truths.lambda_norm[p] = norms.normal;
    if (truths.tangential_norm.size() > 0) truths.tangential_norm[p] = norms.tangential;
    truths.largest_u = std::max(truths.largest_u, truths.u_norm[p]);
    truths.largest_lambda = std::max(truths.largest_lambda, norms.normal);
    truths.largest_tangential = std::max(truths.largest_tangential, norms.tangential);
  }
  return truths;
}

ModelErrors model_errors(const ReducedModel &model, const Matrix &embedding, const Truths &truths,
                         const SparseMatrix &w_product) {
  using Clock = std::chrono::steady_clock;
  const Index count = std::ssize(truths.mu), k = model.primal_size();
  OnlineSolver solver(model);
  const bool friction = truths.tangential_norm.size() > 0;
  const Vector normal = normal_rows(solver.contact());
  ModelErrors errors;
  errors.u.resize(count);
  errors.lambda.resize(count);
  errors.tangential.resize(friction ? count : 0);
  errors.u_floor.resize(count);
  std::vector<double> seconds;
  for (Index p = 0; p < count; ++p) {
    const Vector coordinates = truths.coordinates.col(p);
    Vector outside = coordinates;
    if (embedding.size() > 0)
      outside -= embedding * (embedding.transpose() * coordinates);
    else
      outside.head(k).setZero();
    const double remainder = truths.remainder[p] * truths.remainder[p];
    const auto over_u = [&](const Vector &difference) {
      return relative(std::sqrt(difference.squaredNorm() + remainder), truths.u_norm[p],
                      truths.largest_u);
    };
    errors.u_floor[p] = over_u(outside);
    errors.u[p] = errors.lambda[p] = std::numeric_limits<double>::infinity();
    if (friction) errors.tangential[p] = errors.u[p];
    const auto start = Clock::now();
    const std::optional<ReducedAnswer> answer = answer_at(solver, truths, p);
    if (!answer) {
      ++errors.failed;
      continue;
    }
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    errors.kkt_residual = larger(errors.kkt_residual, answer->residual);
    Vector c = Vector::Zero(truths.coordinates.rows());
    if (embedding.size() > 0)
      c = embedding * answer->u;
    else
      c.head(k) = answer->u;
    errors.u[p] = over_u(coordinates - c);
    const Vector difference = solver.multiplier(*answer) - truths.lambda.col(p);
    const PartNorms norms = part_norms(w_product, difference, normal);
    errors.lambda[p] = relative(norms.normal, truths.lambda_norm[p], truths.largest_lambda);
    if (friction)
      errors.tangential[p] =
          relative(norms.tangential, truths.tangential_norm[p], truths.largest_tangential);
  }
  if (!model.has_multipliers())
    add_stress_floors(model, truths.coordinates.topRows(k), truths, w_product, errors);
  else
    errors.lambda_floor = multiplier_floor(model, truths, w_product);
  std::sort(seconds.begin(), seconds.end());
  if (!seconds.empty()) errors.seconds = seconds[seconds.size() / 2];
  return errors;
}

bool knows_enriched_pairs(const ReducedModel &model) {
  const auto product = model.made.settings.find("pga_product");
  const bool energy = product != model.made.settings.end() && product->second == "energy";
  return model.contact.b.size() == 1 && model.body.supremizers > 0 && !energy;
}

SubModel enriched_pair(const ReducedModel &model, int n, int r) {
  ReducedModel part = leading(model, model.primal_size(), r);
  Matrix vectors = Matrix::Zero(model.primal_size(), n + r);
  vectors.leftCols(n).setIdentity();
  vectors.rightCols(r) = part.contact.b.reduced.col(0).reshaped(r, model.primal_size()).transpose();
  // Modes first, kept as they are; the supremizers orthonormalised against them.
  vectors.rightCols(r).topRows(n).setZero();
  const Matrix rest = orthonormal_range(vectors.rightCols(r));
  Matrix c(model.primal_size(), n + rest.cols());
  c << vectors.leftCols(n), rest;
  return {rebased(part, c, n), c};
}

ValidationErrors summary(const std::vector<const ModelErrors *> &sets) {
  ValidationErrors result;
  const auto add = [&](double error, double &mean, double &max) {
    mean = std::max(mean, 0.0) + error;
    max = std::max(max, error);
  };
  for (const ModelErrors *errors : sets)
    for (Index p = 0; p < errors->u.size(); ++p) {
      if (std::isinf(errors->u[p])) {
        ++result.unanswered;
        continue;
      }
      ++result.count;
      add(errors->u[p], result.u_mean, result.u_max);
      add(errors->lambda[p], result.lambda_mean, result.lambda_max);
      if (errors->tangential.size() > 0)
        add(errors->tangential[p], result.tangential_mean, result.tangential_max);
    }
  for (double *sum : {&result.u_mean, &result.lambda_mean, &result.tangential_mean})
    if (*sum > 0) *sum /= result.count;
  return result;
}

std::string slow_query(double query, double solve) {
  constexpr double part = 0.5;
  if (!(query > 0 && solve > 0 && query >= part * solve)) return "";
  return "a query takes " + short_number(1e3 * query) + " ms, a high-fidelity solve " +
         short_number(1e3 * solve) +
         " ms: reduce to fewer functions (larger tolerances, or -cone_level where multipliers have "
         "hat functions)";
}

} // namespace rbvi
