#include "rbvi/mor/certificate.hpp"

#include "condensed_loads.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/mor/reduce.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"
#include "rbvi/solve/linear.hpp"
#include "shared_stages.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace rbvi {

namespace {

constexpr std::size_t most_axes = 2; ///< parameters of A beside its common coefficient
constexpr double dependent = 1e-13;  ///< what is left of a representer among the others

/// Both ends; of a choice all values but that in the middle.
std::vector<double> beside_middle(const Parameter &of) {
  if (of.choices.empty()) return {of.lower, of.upper};
  std::vector<double> others;
  for (double value = of.lower; value <= of.upper; ++value)
    if (value != taken(of, (of.lower + of.upper) / 2)) others.push_back(value);
  return others;
}

/// The ends and the middle, in its coordinate, of each parameter that A depends on beside its
/// common coefficient, of a choice all its values; the others in the middle. The middle of all
/// comes first.
std::vector<Mu> reference_parameters(const Scene &scene) {
  std::vector<Mu> points{box_centre(scene.parameters)};
  for (const int parameter : parameters_beside_common(scene.a, scene.parameters)) {
    const std::vector<int> &free = scene.parameters.free;
    const auto place = std::ranges::find(free, parameter) - free.begin();
    const Parameter &of = scene.parameters.all[parameter];
    const std::vector<Mu> before = points;
    for (const double value : beside_middle(of))
      for (Mu mu : before) {
        mu[place] = value;
        points.push_back(std::move(mu));
      }
  }
  return points;
}

/// The functions that lift gaps and slips: one for each multiplier that the model can have.
struct LiftedRows {
  std::vector<int> own; ///< CertificateModel::own
  Matrix forces;        ///< dual dofs x m: the multiplier of each
};

LiftedRows lifted_rows(const ReducedModel &model) {
  const Matrix &dual = model.contact.dual_basis;
  LiftedRows rows{std::vector<int>(dual.rows(), -1), Matrix::Zero(dual.rows(), dual.rows())};
  int count = 0; // mirror images have one each: the basis is symmetric to its tolerance alone
  for (Index row = 0; row < dual.rows(); ++row) {
    if (dual.row(row).isZero(0)) continue;
    rows.own[row] = count;
    rows.forces(row, count++) = 1;
  }
  rows.forces.conservativeResize(dual.rows(), count);
  return rows;
}

/// The contact dofs that multipliers of the model push at one of these parameters, rising.
std::vector<int> pushed_dofs(Problem &problem, const ReducedModel &model,
                             const std::vector<Mu> &set) {
  std::set<int> dofs;
  if (model.contact.law)
    dofs.insert(model.contact.law->condensed.dofs.begin(), model.contact.law->condensed.dofs.end());
  Operators op;
  for (const Mu &mu : set) {
    problem.assemble_contact(mu, op);
    for (Index row = 0; row < op.b.rows(); ++row)
      for (SparseMatrix::InnerIterator entry(op.b, row); entry; ++entry)
        if (entry.value() != 0 && !model.contact.dual_basis.row(row).isZero(0))
          dofs.insert(static_cast<int>(entry.col()));
  }
  return {dofs.begin(), dofs.end()};
}

Handle<Mat> solved(KSP ksp, Mat loads) {
  Handle<Mat> result;
  RBVI_CALL(MatDuplicate(loads, MAT_DO_NOT_COPY_VALUES, result.put()));
  RBVI_CALL(KSPMatSolve(ksp, loads, result.get()));
  return result;
}

Handle<Mat> product(Mat a, Mat columns) {
  Handle<Mat> result;
  RBVI_CALL(MatMatMult(a, columns, MAT_INITIAL_MATRIX, PETSC_DEFAULT, result.put()));
  return result;
}

/// The terms of F as columns. Collective.
Handle<Mat> loads_of(const Problem &problem, Mat like) {
  const std::vector<Handle<Vec>> &terms = problem.f_terms().exact;
  Matrix columns(std::ssize(problem.dofs().natural_owned), std::ssize(terms));
  for (Index q = 0; q < columns.cols(); ++q)
    columns.col(q) = local_values(terms[q].get());
  return dense_like(like, columns);
}

/// The residual's parts at the reference that the problem is assembled at.
class Representers {
public:
  /// `x`: columns that are spanned first, not dependent. Collective.
  Representers(const Problem &problem, const Operators &op, Mat x)
      : problem_(problem), a_(op.a), ksp_(make_direct_solver(problem.comm(), "hf_")),
        basis_{make_columns(make_vector(problem.dofs()).get(), 1, op.a)} {
    set_operator(ksp_.get(), a_);
    Vec first = nullptr;
    RBVI_CALL(BVGetColumn(basis_.columns.get(), 0, &first));
    RBVI_CALL(MatGetColumnVector(x, first, 0));
    RBVI_CALL(BVRestoreColumn(basis_.columns.get(), 0, &first));
    RBVI_CALL(BVOrthonormalizeColumn(basis_.columns.get(), 0, PETSC_FALSE, nullptr, nullptr));
    span_terms(x);
  }
  /// Spans A^-1 A_q X of all terms, in which the A^-1 A X = X of all of them together is one.
  void span_terms(Mat x) {
    append_orthonormalised(basis_, x, dependent);
    const std::vector<Handle<Mat>> &terms = problem_.a_terms().exact;
    for (std::size_t q = 1; q < terms.size(); ++q)
      span(product(terms[q].get(), x).get());
  }
  /// A^-1 of columns.
  Handle<Mat> responses(Mat loads) const { return solved(ksp_.get(), loads); }
  void span(Mat loads) { append_orthonormalised(basis_, responses(loads).get(), dependent); }
  /// rank x (terms * columns of x): A_q X term by term.
  Matrix of_terms(Mat x) const {
    const BorrowedColumns columns(basis_.columns.get());
    const std::vector<Handle<Mat>> &terms = problem_.a_terms().exact;
    Matrix result;
    for (std::size_t q = 0; q < terms.size(); ++q) {
      const Matrix part = projected(columns.get(), terms[q].get(), x);
      result.conservativeResize(part.rows(), part.cols() * std::ssize(terms));
      result.middleCols(static_cast<Index>(q) * part.cols(), part.cols()) = part;
    }
    return result;
  }
  Matrix of_loads(Mat loads) const {
    const BorrowedColumns columns(basis_.columns.get());
    Matrix result = BorrowedRows(columns.get()).rows().transpose() * BorrowedRows(loads).rows();
    over_ranks(problem_.comm(), MPI_SUM, result);
    return result;
  }
  Matrix at_contact() const {
    return restrict_to(problem_.trace(), BorrowedColumns(basis_.columns.get()).get());
  }

private:
  const Problem &problem_;
  Mat a_;
  Handle<KSP> ksp_;
  LinearBasis basis_; ///< orthonormal in A
};

/// `lifting`: at the first reference, where it is null, it becomes A^-1 B^T of the multipliers
/// `forces`. Collective.
CertificateReference reference_at(Problem &problem, const Mu &mu, Mat basis, const Matrix &forces,
                                  const std::vector<int> &dofs, Handle<Mat> &lifting) {
  const Operators &op = problem.assemble(mu);
  const Scene &scene = problem.scene();
  const std::vector<double> theta = exact_coefficients(
      scene.a, problem.a_terms().split, scene.parameters, expand(scene.parameters, mu));
  CertificateReference reference;
  reference.theta = Eigen::Map<const Vector>(theta.data(), std::ssize(theta));
  Representers representers(problem, op, basis);
  reference.of_basis = representers.of_terms(basis);
  if (lifting.get() == nullptr)
    lifting =
        representers.responses(extension(problem.trace(), op.b.transpose() * forces, op.a).get());
  representers.span_terms(lifting.get());
  reference.of_lifting = representers.of_terms(lifting.get());
  representers.span(extension(problem.trace(), unit_loads(problem.trace().size, dofs), op.a).get());
  reference.of_contact = representers.at_contact()(dofs, Eigen::all).transpose();
  reference.of_loads = Matrix(reference.of_contact.rows(), 0);
  if (problem.f_terms().exact.empty()) return reference;
  const Handle<Mat> loads = loads_of(problem, op.a);
  representers.span(loads.get());
  reference.of_loads = representers.of_loads(loads.get());
  return reference;
}

/// Whether CertificateModel::by_law holds.
bool is_told_by_law(const Problem &problem, const ReducedModel &model) {
  const ContactModel &contact = model.contact;
  return contact.law && !contact.law->on_functions() && contact.law->condensed.grid.axes.empty() &&
         contact.b.size() == 1 && model.evaluates_gap() && model.body.a_change.rank() == 0 &&
         model.body.a.size() == model.body.a.exact &&
         parameters_beside_common(problem.scene().a, problem.scene().parameters).empty() &&
         contact.dual_basis.rowwise().lpNorm<Eigen::Infinity>().minCoeff() > 0;
}

/// Its root R, R^T R = the product of these columns in A. Collective.
Matrix root_of_product(Mat columns, Mat a) {
  const EigenPairs pairs = eigen_pairs(projected(columns, a, columns));
  return pairs.values.cwiseMax(0).cwiseSqrt().asDiagonal() * pairs.vectors.transpose();
}

/// What the law needs beside itself. Collective.
CertificateModel told_by_law(Problem &problem, const LinearBasis &basis) {
  CertificateModel certificate;
  certificate.by_law = true;
  if (problem.f_terms().exact.empty()) return certificate;
  const Scene &scene = problem.scene();
  const Operators &op = problem.assemble(box_centre(scene.parameters));
  const Handle<KSP> ksp = make_direct_solver(problem.comm(), "hf_");
  set_operator(ksp.get(), op.a);
  Handle<Mat> left = solved(ksp.get(), loads_of(problem, op.a).get());
  const double scale = std::sqrt(common_coefficient(scene.a, scene.parameters, op.mu));
  certificate.of_loads = scale * root_of_product(left.get(), op.a);
  const BorrowedColumns columns(basis.columns.get());
  const Matrix stiffness = projected(columns.get(), op.a, columns.get());
  for (int pass = 0; pass < 2; ++pass) { // of small differences the first leaves round-off
    const Matrix known = lu_solve(stiffness, projected(columns.get(), op.a, left.get()));
    left = dense_like(op.a,
                      BorrowedRows(left.get()).rows() - BorrowedRows(columns.get()).rows() * known);
  }
  certificate.left_of_loads = scale * root_of_product(left.get(), op.a);
  return certificate;
}

} // namespace

std::string no_certificate(const Scene &of) {
  const Scene scene = with_imposed_loads(of);
  if (!has_multipliers(scene)) return "Nitsche's method has no multipliers";
  if (follows_state(scene)) return "contact follows the displacement";
  if (has_mapped_terms(scene.a)) return "A is not a sum of exact terms";
  if (has_mapped_terms(scene.f)) return "the load is not a sum of exact terms";
  if (parameters_beside_common(scene.a, scene.parameters).size() > most_axes)
    return "A depends on more than " + std::to_string(most_axes) + " parameters";
  return "";
}

Certificate make_certificate(Problem &problem, const LinearBasis &basis, const ReducedModel &model,
                             const std::vector<Mu> &training) {
  if (std::string none = no_certificate(problem.scene()); !none.empty()) return {{}, none};
  if (!problem.free_bodies().empty()) return {{}, "contact alone holds a body"};
  if (!model.contact.trace_dofs.empty())
    return {{}, "the model knows displacements near contact alone"};
  if (is_told_by_law(problem, model)) return {told_by_law(problem, basis), ""};
  CertificateModel certificate;
  LiftedRows rows = lifted_rows(model);
  certificate.own = std::move(rows.own);
  certificate.dofs = pushed_dofs(problem, model, training);
  if (std::ssize(certificate.dofs) > most_pushed_dofs)
    return {{}, "multipliers push more than " + std::to_string(most_pushed_dofs) + " contact dofs"};

  const std::vector<Mu> references = reference_parameters(problem.scene());
  Handle<Mat> lifting;
  const BorrowedColumns columns(basis.columns.get());
  for (const Mu &mu : references)
    certificate.references.push_back(
        reference_at(problem, mu, columns.get(), rows.forces, certificate.dofs, lifting));
  certificate.lifting_trace = restrict_to(problem.trace(), lifting.get());
  return {std::move(certificate), ""};
}

} // namespace rbvi
