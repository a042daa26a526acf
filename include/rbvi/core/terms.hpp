// Operators as sums of terms, sum_q theta_q(mu) (form q): a, f and the product of V of a scene.
//
// A term with a coefficient theta, a known function of mu, is *exact*: its kernel does not depend
// on mu and is integrated over the reference domain, once. The kernel of a term without one depends
// on mu, on the mapped domain; empirical interpolation separates the sum of all of these.
#pragma once

#include "rbvi/core/functions.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rbvi {

/// The mean of direction . u over a boundary of the mesh, by its area there.
struct Mean {
  std::string boundary;
  Point direction;
  bool axisymmetric = false;
};

/// An integral over the cells of a region or over the facets of a boundary, one by one.
/// A bilinear form fills rows * columns values (row-major), a linear form rows values: rows for the
/// functions of the cell that it tests with, columns for those it couples them with, nodes *
/// components of either space; a form on one space is square. Nodes of a cell: its vertices and, of
/// degree 2, the middles of its edges (0,1), (1,2), (2,0) and, of a tetrahedron, (0,3), (1,3),
/// (2,3).
struct Form {
  std::string region; ///< "" for the whole domain
  std::function<Kernel> kernel;
  /// Not "": over the facets of this boundary. `cell` is then the one behind the facet, whose
  /// vertices come first and see it outwards (facet_measure); the nodes are the facet's alone.
  std::string boundary = "";
  /// Not empty: no integral of a kernel but, with the sum m of these means, m(u) m(v) of a bilinear
  /// form, m(v) of a linear one. Of exact terms alone.
  std::vector<Mean> means = {};
  /// Not of the cells of these regions, or the facets of these boundaries ("": of any): other terms
  /// have them.
  std::vector<std::string> without = {};
  explicit operator bool() const { return kernel || !means.empty(); }
};

/// A factor of a coefficient.
struct Factor {
  std::string name; ///< two factors of one name are the same function
  std::function<Coefficient> value;
  std::vector<int> parameters; ///< indices into parameters.all that it depends on
};

struct Term {
  Form form;
  /// theta, the product of these; unset: the kernel depends on mu.
  std::optional<std::vector<Factor>> theta;
  /// Without theta: the parameters (as in Factor) that the kernel depends on; unset: all.
  std::optional<std::vector<int>> parameters = {};
  bool of_imposed = false;    ///< a load made by with_imposed_loads (element/imposed.hpp)
  bool of_contact = false;    ///< the pull of adhesion: outputs have it among the forces of contact
  bool of_order_zero = false; ///< c u of a membrane, in which a constant does work
};

using Sum = std::vector<Term>;

/// theta = the product of `factors`; without factors 1.
Term exact_term(Form form, std::vector<Factor> factors = {});
/// A kernel that depends on mu.
Term mapped_term(Form form, std::optional<std::vector<int>> parameters = {});

/// theta of an exact term.
double coefficient_of(const Term &term, const FullMu &all_parameters);

/// Exact terms whose coefficients are multiples of each other over the free parameters.
struct ExactGroup {
  struct Member {
    int term;      ///< number in the sum
    double weight; ///< product of its factors that the fixed parameters make constant
  };
  std::vector<Member> members;
  std::vector<int> factors; ///< those of the first member that vary; none: it is constant
};

/// A sum over the free parameters of a space.
struct SplitSum {
  std::vector<ExactGroup> exact; ///< the constant one first, where there is one
  std::vector<int> mapped;       ///< numbers of the terms without a coefficient
};

/// Throws bad_input for a factor that is not finite at the fixed parameters.
SplitSum split_sum(const Sum &sum, const ParameterSpace &space);

/// The coefficient of each group at mu: the product of its factors that vary. Throws bad_input
/// where one is not finite.
std::vector<double> exact_coefficients(const Sum &sum, const SplitSum &split,
                                       const ParameterSpace &space, const FullMu &all_parameters);

/// The product of the varying factors that every term has: the sum is that times what is left of
/// each term. 1 where they share none.
double common_coefficient(const Sum &sum, const ParameterSpace &space,
                          const FullMu &all_parameters);

/// The free parameters, indices into parameters.all, that the sum over its common coefficient
/// depends on.
std::vector<int> parameters_beside_common(const Sum &sum, const ParameterSpace &space);

/// Whether some term depends on a parameter, an index into parameters.all.
bool depends_on(const Sum &sum, int parameter);

/// Whether the sum is the same for all values of the free parameters.
bool is_constant(const Sum &sum, const ParameterSpace &space);

/// Values of the parameters that some term depends on.
std::vector<double> values_of_dependence(const Sum &sum, const FullMu &all_parameters);

/// Throws bad_input where a factor is not finite.
void check_coefficients(const Sum &sum, const ParameterSpace &space, const FullMu &all_parameters);

} // namespace rbvi
