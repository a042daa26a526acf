// The mistakes of whoever writes a scene that no solve would show: refused before work starts, at
// the cost of a few cells and points.
#pragma once

#include "rbvi/core/scene.hpp"
#include "rbvi/fem/problem.hpp"

namespace rbvi {

/// Of what needs no mesh. Throws bad_input, naming the part of the scene, where a function is not
/// set or asks for a parameter that is not there; a factor, an imposed displacement or the kernel
/// of an exact term depends on a parameter that it does not declare; two factors of one name
/// differ; a coordinate and its inverse do not fit. Problem asks this.
void check_functions(const Scene &scene);

/// The same of the rest, on a mesh. Throws bad_input where on some cells or facets
/// - a form fills another number of values than its components and degree have, values that are
///   not finite, or a bilinear one values that are not symmetric;
/// - a mapped term, or the kernel of an exact one, depends on a parameter that it does not declare;
/// - an exact term is no multiple of what its kernel is on the mapped domain, or one by a function
///   of parameters that its coefficient does not declare;
/// - the motion of the scene does work in a;
/// - a normal of contact is not of length 1, points into the body, or is no gradient of the
///   distance.
/// Boundaries are those of check_facts. Collective.
void check_scene(const Problem &problem);

/// `mu` with another value of one parameter, near by, in its range.
FullMu with_other_value(const ParameterSpace &space, FullMu mu, std::size_t parameter);

/// Whether two values, or lists of them, differ by more than round-off.
bool differ(double one, double other);
bool differ(const Vector &one, const Vector &other);

/// What `work` returns; `what` is a function of the scene. Throws bad_input in place of what the
/// standard library throws for a function that is not set or an index that is not there.
template <class Work> decltype(auto) asked(const std::string &what, Work &&work) {
  try {
    return std::forward<Work>(work)();
  } catch (const std::bad_function_call &) {
    throw bad_input(what + " is not set, or asks for a function that is not");
  } catch (const std::out_of_range &) {
    throw bad_input(what + " asks for a parameter or a name that the scene does not have");
  }
}

/// Throws bad_input for an exact term whose kernel depends on parameters, or fills another number
/// of values than the scene has: assembled without parameters it might end the program.
void check_exact_kernels(const Scene &scene);

} // namespace rbvi
