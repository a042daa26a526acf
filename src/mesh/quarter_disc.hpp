// A quarter of a disc, graded to its contact arc and to the points where its stress is singular.
#pragma once

#include "rings.hpp"

namespace rbvi {

struct QuarterDisc {
  double contact_angle; ///< of the contact arc, from the lowest point on
  int edges;            ///< of the contact arc, equal ones
  double growth;        ///< of the edges, per distance from the contact arc
  double corner_edge;   ///< at the corner of the flat side: clamped there, the stress is singular
  double rim_edge;     ///< where the rim of the core meets the flat side: singular, too, if clamped
                       ///< and the core is soft or stiff
  double longest_edge; ///< along the rings; across them half as much again
  double inner_end;    ///< angle where the last ring below the core leaves the core's arc
  double outer_end;    ///< angle where it meets the boundary of the disc
};

/// The quarter x >= 0, y <= 0 of the disc of radius 1 about the origin. Region "core": |x| <= 0.6,
/// which the mesh fits. Boundaries: "contact", "arc" (the whole quarter circle, the contact arc
/// included), "axis" (x = 0), "top" (y = 0). Deterministic: rings at growing distances from the
/// contact arc, which turn into the core's arc, then rows along the rest of that arc and rings in
/// the core.
SerialMesh quarter_disc(const QuarterDisc &shape);

} // namespace rbvi
