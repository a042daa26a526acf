// A matrix or a vector as a sum of terms (core/terms.hpp) on a mesh: what each group of exact terms
// assembles to is kept, so that a new mu costs one addition for each; the terms whose kernels
// depend on mu are assembled again.
#pragma once

#include "rbvi/fem/assembly.hpp"

namespace rbvi {

/// `Object`: Mat or Vec, all of one pattern.
template <class Object> struct Summed {
  SplitSum split;
  std::vector<Handle<Object>> exact; ///< one for each group of split.exact
  Handle<Object> mapped;             ///< the other terms at the mu of the last sum_up
  Handle<Object> total;
  std::optional<std::vector<double>> made_at{}; ///< values_of_dependence
  std::vector<LoadSums> exact_sums{};           ///< of a load: of each group
  LoadSums sums{};                              ///< of the load `total`
};

/// Assembles the exact groups: integrals over the reference domain, of kernels that depend on no
/// parameter. Collective.
template <class Object>
Summed<Object> make_summed(const Sum &sum, const ParameterSpace &space, const Mesh &mesh,
                           const Dofs &dofs);

/// Whether the sum at mu is another one than the last.
template <class Object>
bool differs(const Summed<Object> &summed, const Sum &sum, const FullMu &all_parameters) {
  return summed.made_at != values_of_dependence(sum, all_parameters);
}

/// Where terms are assembled.
struct Domain {
  const Mesh &mesh;
  const Dofs &dofs;
  const MappedVertices &mapped; ///< at mu, where there are terms that depend on the map
};

/// summed.total at mu. Collective. Throws bad_input for a coefficient or an entry that is not
/// finite.
template <class Object>
void sum_up(const Sum &sum, const ParameterSpace &space, const FullMu &all_parameters,
            const Domain &domain, Summed<Object> &summed);

extern template Summed<Mat> make_summed(const Sum &, const ParameterSpace &, const Mesh &,
                                        const Dofs &);
extern template Summed<Vec> make_summed(const Sum &, const ParameterSpace &, const Mesh &,
                                        const Dofs &);
extern template void sum_up(const Sum &, const ParameterSpace &, const FullMu &, const Domain &,
                            Summed<Mat> &);
extern template void sum_up(const Sum &, const ParameterSpace &, const FullMu &, const Domain &,
                            Summed<Vec> &);

} // namespace rbvi
