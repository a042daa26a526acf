#include "rbvi/study/separation_errors.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/mor/operator_entries.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"

#include <algorithm>
#include <functional>

namespace rbvi {

namespace {

/// One interpolation.
struct Separated {
  std::string name;
  Index terms;
  std::function<Vector(const Operators &)> values; ///< this rank's entries
  std::function<Vector(const FullMu &)> theta;     ///< at all parameters, of a query
};

/// Adds the parts of b: all rows, or B^n and B^tau, by the first entries of its terms and of its
/// values.
void add_contact(const ReducedModel &model, const Problem &problem, std::vector<Separated> &parts) {
  const auto theta = [&](const FullMu &all) {
    return contact_coefficients(model.contact.b, Part::b, problem.contact(), problem.scene(), all);
  };
  const Index normal = model.contact.law ? model.contact.law->apart.normal : 0;
  if (normal == 0) {
    parts.push_back({"b", model.contact.b.size(),
                     [](const Operators &op) { return nonzero_values(op.b); }, theta});
    return;
  }
  const auto entries_of_normal = [](const Operators &op) {
    return Index{op.b.outerIndexPtr()[op.laws.nodes()]};
  };
  const Index tangential = model.contact.b.size() - normal;
  parts.push_back({"b_normal", normal,
                   [=](const Operators &op) -> Vector {
                     return nonzero_values(op.b).head(entries_of_normal(op));
                   },
                   [=](const FullMu &all) -> Vector { return theta(all).head(normal); }});
  parts.push_back({"b_tangential", tangential,
                   [=](const Operators &op) -> Vector {
                     return nonzero_values(op.b).tail(op.b.nonZeros() - entries_of_normal(op));
                   },
                   [=](const FullMu &all) -> Vector { return theta(all).tail(tangential); }});
}

/// The interpolated operators. `triangle`, `problem` and `model` must outlive them.
std::vector<Separated> separated(const LowerTriangle &triangle, const Problem &problem,
                                 const ReducedModel &model) {
  const Scene &scene = problem.scene();
  std::vector<Separated> parts;
  const auto theta = [&scene](const AffineTerms &terms, const Sum &sum) {
    return [&](const FullMu &all) -> Vector {
      return affine_coefficients(terms, sum, scene, all).tail(terms.size() - terms.exact);
    };
  };
  parts.push_back(
      {"a", model.body.a.size() - model.body.a.exact,
       [&](const Operators &) { return triangle.values(problem.a_terms().mapped.get()); },
       theta(model.body.a, scene.a)});
  add_contact(model, problem, parts);
  parts.push_back(
      {"f", model.body.f.size() - model.body.f.exact,
       [&problem](const Operators &) { return local_values(problem.f_terms().mapped.get()); },
       theta(model.body.f, scene.f)});
  parts.push_back({"g", model.contact.g.size(), [](const Operators &op) { return op.g; },
                   [&](const FullMu &all) {
                     return contact_coefficients(model.contact.g, Part::g, problem.contact(), scene,
                                                 all);
                   }});
  std::erase_if(parts, [](const Separated &part) { return part.terms == 0; });
  return parts;
}

const std::vector<double> &history(const ReducedModel &model, const std::string &name) {
  const auto found = model.made.histories.find(name);
  if (found == model.made.histories.end())
    throw failure("the model has no history " + name + ": reduce again");
  return found->second;
}

/// The functions that theta combines: at the mu where term i was chosen the first i + 1 of them
/// sum up to the operator. Entries x terms. Collective.
Matrix functions_of(Problem &problem, const ReducedModel &model, const Separated &part) {
  const std::vector<double> &selected = history(model, "eim_selected/" + part.name);
  if (std::ssize(selected) != part.terms)
    throw failure("the model does not say where the terms of " + part.name + " are from");
  Matrix functions;
  for (Index i = 0; i < part.terms; ++i) {
    const auto number = static_cast<Index>(selected[i]);
    if (number < 0 || number >= model.made.trained_mu.cols())
      throw failure("the terms of " + part.name + " are from no training parameter of the model");
    const Vector column = model.made.trained_mu.col(number);
    const Operators &op = problem.assemble({column.begin(), column.end()});
    const Vector values = part.values(op), theta = part.theta(op.mu);
    if (i == 0) functions.resize(values.size(), part.terms);
    functions.col(i) = (values - functions.leftCols(i) * theta.head(i)) / theta[i];
  }
  return functions;
}

/// Raises the entries of `largest` to what is left with 0, 1, ... terms.
void add_remainders(Vector values, const Matrix &functions, const Vector &theta, Vector &largest) {
  const auto raise = [&](Index j) {
    if (values.size() > 0) largest[j] = std::max(largest[j], values.cwiseAbs().maxCoeff());
  };
  raise(0);
  for (Index j = 0; j < theta.size(); ++j) {
    values -= theta[j] * functions.col(j);
    raise(j + 1);
  }
}

} // namespace

std::vector<SeparationErrors> separation_errors(Problem &problem, const ReducedModel &model,
                                                const std::vector<Mu> &validation) {
  if (validation.empty()) return {};
  const LowerTriangle triangle(problem.assemble(validation.front()).a, problem.dofs());
  const std::vector<Separated> parts = separated(triangle, problem, model);
  std::vector<Matrix> functions;
  std::vector<Vector> largest;
  for (const Separated &part : parts) {
    functions.push_back(functions_of(problem, model, part));
    largest.push_back(Vector::Zero(part.terms + 1));
  }
  for (const Mu &mu : validation) {
    const Operators &op = problem.assemble(mu);
    for (std::size_t k = 0; k < parts.size(); ++k)
      add_remainders(parts[k].values(op), functions[k], parts[k].theta(op.mu), largest[k]);
  }
  std::vector<SeparationErrors> result;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    Vector &left = largest[k];
    over_ranks(problem.comm(), MPI_MAX, left);
    if (const double scale = left[0]; scale > 0) left /= scale;
    result.push_back(
        {parts[k].name, history(model, "eim/" + parts[k].name), {left.begin(), left.end()}});
  }
  return result;
}

} // namespace rbvi
