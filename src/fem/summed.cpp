#include "rbvi/fem/summed.hpp"

#include "rbvi/core/error.hpp"

#include <cmath>

namespace rbvi {

namespace {

template <class Object> Handle<Object> make(const Mesh &mesh, const Dofs &dofs) {
  if constexpr (std::is_same_v<Object, Mat>)
    return make_matrix(mesh, dofs);
  else
    return make_vector(dofs);
}

Handle<Mat> copy_of(Mat matrix) {
  Handle<Mat> copy;
  RBVI_CALL(MatDuplicate(matrix, MAT_COPY_VALUES, copy.put()));
  for (const MatOption option : {MAT_SYMMETRIC, MAT_SYMMETRY_ETERNAL, MAT_SPD})
    RBVI_CALL(MatSetOption(copy.get(), option, PETSC_TRUE));
  return copy;
}

Handle<Vec> copy_of(Vec vector) {
  Handle<Vec> copy;
  RBVI_CALL(VecDuplicate(vector, copy.put()));
  return copy;
}

void set_zero(Mat matrix) {
  RBVI_CALL(MatZeroEntries(matrix));
}

void set_zero(Vec vector) {
  RBVI_CALL(VecZeroEntries(vector));
}

void add(double factor, Mat term, Mat total) {
  RBVI_CALL(MatAXPY(total, factor, term, SAME_NONZERO_PATTERN));
}

void add(double factor, Vec term, Vec total) {
  RBVI_CALL(VecAXPY(total, factor, term));
}

LoadSums fill(const std::vector<WeightedForm> &forms, const FullMu &mu, const Domain &domain,
              Mat matrix) {
  assemble(forms, mu, domain.mesh, domain.dofs, domain.mapped, matrix);
  return {};
}

LoadSums fill(const std::vector<WeightedForm> &forms, const FullMu &mu, const Domain &domain,
              Vec vector) {
  return assemble(forms, mu, domain.mesh, domain.dofs, domain.mapped, vector);
}

/// Throws bad_input where an entry is not finite: some norms pass over what is no number, these two
/// do not.
void check_finite(Mat stiffness, const std::string &where) {
  PetscReal norm = 0;
  RBVI_CALL(MatNorm(stiffness, NORM_FROBENIUS, &norm));
  if (!std::isfinite(norm))
    throw bad_input("the stiffness is not finite at " + where +
                    ": some function in the terms of a is not, at some point of the body");
}

void check_finite(Vec load, const std::string &where) {
  PetscReal norm = 0;
  RBVI_CALL(VecNorm(load, NORM_1, &norm));
  if (!std::isfinite(norm))
    throw bad_input("the load is not finite at " + where +
                    ": some function in the terms of f is not, at some point of the body");
}

} // namespace

template <class Object>
Summed<Object> make_summed(const Sum &sum, const ParameterSpace &space, const Mesh &mesh,
                           const Dofs &dofs) {
  Summed<Object> result{split_sum(sum, space), {}, {}, {}};
  for (const ExactGroup &group : result.split.exact) {
    std::vector<WeightedForm> forms;
    for (const auto &[term, weight] : group.members)
      forms.push_back({&sum[term].form, weight, sum[term].of_imposed});
    result.exact.push_back(make<Object>(mesh, dofs));
    result.exact_sums.push_back(fill(forms, {}, {mesh, dofs, {}}, result.exact.back().get()));
  }
  const bool mapped = !result.split.mapped.empty();
  if (mapped) result.mapped = make<Object>(mesh, dofs);
  if (mapped && result.exact.empty())
    result.total = share(result.mapped);
  else if (!mapped && is_constant(sum, space) && result.exact.size() == 1)
    result.total = share(result.exact.front());
  else
    result.total =
        result.exact.empty() ? make<Object>(mesh, dofs) : copy_of(result.exact.front().get());
  return result;
}

template <class Object>
void sum_up(const Sum &sum, const ParameterSpace &space, const FullMu &all_parameters,
            const Domain &domain, Summed<Object> &summed) {
  const std::vector<double> coefficients =
      exact_coefficients(sum, summed.split, space, all_parameters);
  summed.made_at.reset();
  summed.sums = {};
  if (summed.mapped) {
    std::vector<WeightedForm> forms;
    for (const int term : summed.split.mapped)
      forms.push_back({&sum[term].form, 1, sum[term].of_imposed});
    summed.sums = fill(forms, all_parameters, domain, summed.mapped.get());
  }
  for (std::size_t q = 0; q < summed.exact.size(); ++q)
    summed.sums = summed.sums + coefficients[q] * summed.exact_sums[q];
  const Object total = summed.total.get();
  const bool is_one = total == summed.mapped.get() ||
                      (!summed.exact.empty() && total == summed.exact.front().get());
  if (!is_one) {
    set_zero(total);
    for (std::size_t q = 0; q < summed.exact.size(); ++q)
      add(coefficients[q], summed.exact[q].get(), total);
    if (summed.mapped) add(1, summed.mapped.get(), total);
  }
  check_finite(total, describe(space, all_parameters));
  summed.made_at = values_of_dependence(sum, all_parameters);
}

template Summed<Mat> make_summed(const Sum &, const ParameterSpace &, const Mesh &, const Dofs &);
template Summed<Vec> make_summed(const Sum &, const ParameterSpace &, const Mesh &, const Dofs &);
template void sum_up(const Sum &, const ParameterSpace &, const FullMu &, const Domain &,
                     Summed<Mat> &);
template void sum_up(const Sum &, const ParameterSpace &, const FullMu &, const Domain &,
                     Summed<Vec> &);

} // namespace rbvi
