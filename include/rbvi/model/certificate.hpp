// The bound of method/certificate.hpp of a reduced answer, from what the model keeps for it. B and
// g are those of mu on the interfaces, at every node, and l_N is made one that the law allows
// first, so that no approximation of the model enters. A is a sum of exact terms; the norm of a
// residual follows from those at a few reference parameters (norm_over_references).
//
// Where the law is that of the whole body at all nodes (CertificateModel::by_law), l_N is its
// multiplier, and what u_N lacks of the body's answer to f and l_N tells the difference of the
// energies of both: no residual is formed, and no gap is lifted. Being a difference, such a bound
// ends at 1e-7 of |u_N|.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/model/answer.hpp"
#include "rbvi/model/model.hpp"

#include <optional>

namespace rbvi {

/// In the norm of A(mu), of the part of the body that is modelled.
struct AnswerBound {
  struct Interval {
    double lower, upper;
  };
  double error; ///< of |u - u_N|, and of |B^T (l - l_N)| in A^-1
  double size;  ///< |u_N|
  /// The law is one for which it is a bound: none of friction, or Tresca's with the same threshold
  /// everywhere. Else it is that of the problem whose bound of friction is the answer's own.
  bool certified;
  /// Of the energy of u, what imposed values add to it included; without friction.
  std::optional<Interval> energy{};
  /// Likewise of what the multipliers add up to: their integral, their push on the first body along
  /// y.
  std::optional<Interval> normal_force{}, reaction{};
};

/// `lambda`: of the answer, at the dual dofs; `imposed_energy`: what of its energy is that of
/// imposed values alone; `forces`: whether they are asked for. Nothing where the model keeps
/// nothing for it, where multipliers push or gaps are open at nodes of which it knows nothing, or
/// where A is outside of what its references span.
std::optional<AnswerBound> bound_of(const ReducedModel &model, const Scene &scene,
                                    const Contact &contact, const ReducedAnswer &answer,
                                    const Vector &lambda, double imposed_energy, bool forces);

/// Of CertificateModel::by_law. `laws`: of the columns of the dual basis at mu.
AnswerBound bound_by_law(const ReducedModel &model, const Scene &scene, const NodeLaws &laws,
                         const ReducedAnswer &answer, double imposed_energy);

class BasisChange;
void change_certificate(const BasisChange &to, CertificateModel &certificate);

} // namespace rbvi
