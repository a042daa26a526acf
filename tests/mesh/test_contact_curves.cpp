// Boundaries with loads or contact: on the surface, and the chains of those of contact.
#include "../core/refuses.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/mesh/contact_curves.hpp"
#include "rbvi/mesh/serial.hpp"
#include "rbvi/mesh/surface.hpp"
#include "tests/catalogue.hpp"

#include <cmath>

namespace rbvi::contact_curves_test {
namespace {

const std::string name = "contact";

Scene block() {
  return make_scene("patch", {{"bodies", "one"}});
}

double middle(const SerialMesh &mesh, const std::array<int, 3> &facet) {
  return (mesh.points[facet[0]][0] + mesh.points[facet[1]][0]) / 2;
}

std::vector<CurvePiece> pieces_of(const SerialMesh &mesh, const std::string &boundary = name) {
  return curve_pieces(mesh, boundary, "the mesh");
}

/// The angle from which the body lies on the left: of a closed piece +-2 pi, about the origin.
double turns(const SerialMesh &mesh, const CurvePiece &piece) {
  double angle = 0;
  const auto at = [&](std::size_t i) { return mesh.points[piece.vertices[i]]; };
  for (std::size_t i = 0; i < piece.vertices.size(); ++i) {
    const Point a = at(i), b = at((i + 1) % piece.vertices.size());
    angle += std::atan2(a[0] * b[1] - a[1] * b[0], dot(a, b));
  }
  return angle;
}

TEST(ContactCurves, FollowTheFacetsWithTheBodyOnTheLeft) {
  const SerialMesh mesh = one_block();
  const std::vector<CurvePiece> pieces = pieces_of(mesh);
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_FALSE(pieces[0].loop);
  ASSERT_EQ(pieces[0].vertices.size(), 9U);
  for (std::size_t i = 1; i < 9; ++i)
    EXPECT_LT(mesh.points[pieces[0].vertices[i - 1]][0], mesh.points[pieces[0].vertices[i]][0]);
  const std::vector<CurvePiece> top = pieces_of(mesh, "top");
  EXPECT_GT(mesh.points[top[0].vertices.front()][0], mesh.points[top[0].vertices.back()][0]);
  SerialMesh turned = mesh; // the order of facets and of their ends does not matter
  for (auto &facet : turned.boundary[name])
    std::swap(facet[0], facet[1]);
  std::ranges::reverse(turned.boundary[name]);
  EXPECT_EQ(pieces_of(turned)[0].vertices, pieces[0].vertices);
}

/// The rim of a polygon that is named by no curve; refined, its edges stay as far off.
TEST(ContactCurves, AreOffTheArcsThatNoCurveNames) {
  Scene scene = make_scene("rigid_disk");
  const SerialMesh mesh = mesh_with_groups(scene, "");
  EXPECT_TRUE(off_arcs(mesh, scene).empty());
  scene.curves.clear();
  const std::vector<std::pair<std::string, double>> off = off_arcs(mesh, scene);
  ASSERT_EQ(off.size(), 1U);
  EXPECT_EQ(off[0].first, "contact");
  double edge = 0; // of the unit circle
  for (const auto &facet : mesh.boundary.at("contact"))
    edge = std::max(edge, norm(mesh.points[facet[0]] - mesh.points[facet[1]]));
  EXPECT_NEAR(off[0].second, 1 - std::sqrt(1 - edge * edge / 4), 1e-3 * off[0].second);
  EXPECT_TRUE(off_arcs(one_block(), block()).empty());
}

TEST(ContactCurves, AreInSeveralPiecesUprightOrClosed) {
  SerialMesh mesh = one_block();
  std::erase_if(mesh.boundary[name],
                [&](const auto &facet) { return std::abs(middle(mesh, facet) - 0.55) < 0.1; });
  EXPECT_EQ(pieces_of(mesh).size(), 2U);
  EXPECT_EQ(pieces_of(mesh, "sides").size(), 2U) << "upright";
  SerialMesh around = one_block();
  for (const char *side : {"sides", "top"})
    for (const auto &facet : around.boundary[side])
      around.boundary[name].push_back(facet);
  const std::vector<CurvePiece> all = pieces_of(around);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_TRUE(all[0].loop);
  EXPECT_EQ(all[0].vertices.size(), around.boundary[name].size()) << "each once";
  EXPECT_EQ(all[0].closed_ends, (std::array{true, true})) << "no ends";
  const SerialMesh ring = annulus(8);
  EXPECT_NEAR(turns(ring, pieces_of(ring, "rim")[0]), 2 * M_PI, 1e-12);
  EXPECT_NEAR(turns(ring, pieces_of(ring, "hub")[0]), -2 * M_PI, 1e-12) << "the body is outside";
}

TEST(ContactCurves, ThatMeetThemselvesAreRefused) {
  // Two triangles with one common vertex, all of their edges.
  SerialMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  mesh.cells = {{0, 1, 2, -1}, {0, 3, 4, -1}};
  for (const auto &cell : mesh.cells)
    for (std::size_t i = 0; i < 3; ++i)
      mesh.boundary[name].push_back({cell[i], cell[(i + 1) % 3], -1});
  EXPECT_TRUE(refuses("the contact boundary 'contact' of the mesh meets itself at (0, 0): give",
                      [&] { (void)pieces_of(mesh); }));
}

using Ends = std::array<bool, 2>;

Ends closed_ends(const SerialMesh &mesh, const std::string &boundary) {
  return pieces_of(mesh, boundary).front().closed_ends;
}

/// A polygon of so many edges about the origin, its triangles from there, with two of the edges.
SerialMesh polygon(int edges) {
  SerialMesh mesh;
  mesh.points = {{0, 0, 0}};
  for (int k = 0; k < edges; ++k) {
    const double angle = 2 * M_PI * k / edges - M_PI / 2;
    mesh.points.push_back({std::cos(angle), std::sin(angle), 0});
    mesh.cells.push_back({0, 1 + k, 1 + (k + 1) % edges, -1});
  }
  mesh.boundary[name] = {{edges, 1, -1}, {1, 2, -1}};
  return mesh;
}

TEST(ContactCurves, ABodyEndsWhereItsSurfaceTurnsAway) {
  EXPECT_EQ(closed_ends(one_block(), name), (Ends{true, true}));
  EXPECT_EQ(closed_ends(two_blocks(), "master"), (Ends{true, true}));
  for (const int edges : {8, 100}) {
    EXPECT_EQ(closed_ends(half_disc(edges), name), (Ends{false, false})) << "the arc goes on";
    EXPECT_EQ(closed_ends(refined(half_disc(edges)), name), (Ends{false, false}));
  }
  EXPECT_EQ(closed_ends(annulus(8), "top"), (Ends{false, false}));
  const SerialMesh discs = two_graded_quarter_discs(8); // from the axis of symmetry, and to it
  EXPECT_EQ(closed_ends(discs, "slave"), (Ends{true, false}));
  EXPECT_EQ(closed_ends(discs, "master"), (Ends{false, true}));
  EXPECT_EQ(closed_ends(polygon(8), name), (Ends{true, true})) << "a chamfer is no arc";
  EXPECT_EQ(closed_ends(polygon(12), name), (Ends{false, false})) << "a coarse circle is one";
  SerialMesh part = one_block();
  std::erase_if(part.boundary[name], [&](const auto &facet) { return middle(part, facet) > 0.5; });
  EXPECT_EQ(closed_ends(part, name), (Ends{true, false})) << "a part of a flat face";
}

/// A prism over triangles A B C, B C D, ..., from z = 0 to 1: its foot, on y = 0 from A = (-1, 0)
/// to B, and the sides that begin there at these angles, inside of the body, from the foot.
SerialMesh prism(const std::vector<double> &degrees) {
  SerialMesh mesh;
  mesh.dim = 3;
  std::vector<Point> outline{{0, 0, 0}, {-1, 0, 0}};
  for (const double of : degrees)
    outline.push_back({-std::cos(of * M_PI / 180), std::sin(of * M_PI / 180), 0});
  for (const double z : {0.0, 1.0})
    for (Point x : outline) {
      x[2] = z;
      mesh.points.push_back(x);
    }
  const auto up = static_cast<int>(outline.size());
  for (int k = 2; k < up; ++k) // the triangle 0, k - 1, k and that above it
    for (const auto &cell : {std::array{0, k - 1, k, up + k},
                             {0, k - 1, up + k - 1, up + k},
                             {0, up, up + k - 1, up + k}})
      mesh.cells.push_back(cell);
  mesh.boundary[name] = {{0, 1, up + 1}, {0, up, up + 1}};
  return mesh;
}

TEST(ContactCurves, ASolidEndsWhereItsSurfaceTurnsAway) {
  const auto open = [](const std::vector<double> &degrees) {
    const std::vector<PetscInt> rim = open_rim(prism(degrees), name);
    const auto up = static_cast<PetscInt>(degrees.size() + 2);
    EXPECT_TRUE(rim.empty() || rim == (std::vector<PetscInt>{0, up}));
    return !rim.empty();
  };
  EXPECT_FALSE(open({20})) << "a blade is sharp, though both of its sides are nearly in one plane";
  EXPECT_FALSE(open({90}));
  EXPECT_FALSE(open({70, 135})) << "a chamfer";
  EXPECT_TRUE(open({75, 150})) << "a fillet in coarse steps";
  EXPECT_TRUE(open({90, 180})) << "a part of a flat side";
  EXPECT_TRUE(open({75, 150, 225})) << "a notch, beyond which the body goes on";
}

TEST(ContactCurves, LoadsAndContactAreOnTheSurface) {
  Scene scene = block();
  scene.mesh.facts.clear();
  scene.mesh.boundaries.emplace_back("load");
  SerialMesh mesh = one_block();
  mesh.boundary["load"] = {mesh.boundary["sides"].front()};
  EXPECT_NO_THROW(check_facts(mesh, scene, "the mesh"));
  // An edge that two cells share.
  const auto &[a, b] = std::pair{mesh.cells[0], mesh.cells[1]};
  std::array<int, 3> inner{-1, -1, -1};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i)
    if (std::ranges::count(b, a[i]) > 0) inner[count++] = a[i];
  ASSERT_EQ(count, 2u);
  mesh.boundary["load"] = {inner};
  EXPECT_NO_THROW(check_facts(mesh, scene, "the mesh")) << "nothing is there";
  scene.f.push_back(exact_term(pressure_load("load", 1, 2, 1)));
  const std::string refusal =
      "'load' of the mesh is not on the surface of the body: the facet from";
  EXPECT_TRUE(refuses(refusal, [&] { check_facts(mesh, scene, "the mesh"); }));
  scene.f.pop_back();
  scene.contacts.front().entities.parts = {"load"};
  EXPECT_TRUE(refuses(refusal, [&] { check_facts(mesh, scene, "the mesh"); }));
}

} // namespace
} // namespace rbvi::contact_curves_test
