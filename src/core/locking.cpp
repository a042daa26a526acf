#include "rbvi/core/locking.hpp"

#include "rbvi/core/text.hpp"

#include <algorithm>

namespace rbvi {

double locking_ratio(const Scene &scene, const FullMu &all_parameters,
                     const std::vector<MaterialPoint> &points) {
  // On the default meshes of the cases roller and rigid_disk forces of degree 1 are too large by 4
  // and 2 % at a ratio of 0.45, 8 and 3 % at 0.48, 13 and 5 % at 0.49, 44 and 15 % at 0.499; the
  // largest pressure of roller is 1.4, 1.9, 2.3 and 4.2 times that of degree 2. Of Lame's tube,
  // axisymmetric, on 16 edges across the energy of degree 1 is 7 % off at 0.499 and that of degree
  // 2 3e-5 (Axisymmetric.DegreeTwoDoesNotLock).
  constexpr double locks_from = 0.48;
  if (scene.degree != 1 || scene.materials.empty()) return 0;
  double largest = 0;
  for (const auto &[x, material] : points) {
    const auto [lambda, shear] = scene.materials[material].of_cell(all_parameters, x);
    largest = std::max(largest, lambda / (2 * (lambda + shear)));
  }
  return largest < locks_from - 1e-12 ? 0 : largest;
}

void warn_of_elements(const Scene &scene, double ratio, std::ostream &out) {
  if (ratio != 0)
    out << "warning: Poisson's ratio is " << short_number(ratio)
        << ", where elements of degree 1 lock: forces may be a tenth or more too large, peaks of "
           "the pressure twice or more, and a finer mesh does not mend that: use -degree 2\n";
  // Of membrane_obstacle the peak is 1.8 times that by vertex quadrature, refined once 1.6 times;
  // force and energy differ by 1e-3.
  if (std::ranges::any_of(scene.contacts, [](const ContactRecipe &contact) {
        return contact.entities.kind == InterfaceEntities::Kind::cells && !contact.nodal;
      }))
    out << "warning: with lumped: no above an obstacle pressures at nodes beside the edge of "
           "contact are up to 1.8 times too large, peak_pressure among them, and a finer mesh does "
           "not mend that: use lumped: yes; forces and displacements are right\n";
  // Of patch on one body, 8 edges, the force is 0.83 of its value, of rigid_disk 0.991 on 100.
  if (scene.degree == 2 && std::ranges::any_of(scene.contacts, [](const ContactRecipe &contact) {
        return contact.entities.kind == InterfaceEntities::Kind::facets && contact.nodal;
      }))
    out << "warning: lumped: yes holds vertices alone, and nodes of degree 2 between them sink in: "
           "forces are of order one in the length of an edge, a sixth too small on 8 edges: use "
           "degree: 1, or leave lumped out\n";
}

} // namespace rbvi
