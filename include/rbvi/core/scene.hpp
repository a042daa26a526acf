// A scene: the pure functions and facts that define one parametrised variational inequality
//
//   a(mu; u, v) + b(mu; v, lambda) = f(mu; v)          for all v in V
//   b(mu; u, eta) <= g(mu; eta)                        for all eta in W+        (2.7)
//
// on a reference domain. Nothing here knows of meshes in memory, MPI or PETSc, so the same
// scene serves the offline assembly and the online evaluation of sampled entries.
// Niakh (2022): (1.1)-(1.6), (1.8)-(1.12), (2.1), (2.2), (2.5), (2.6), (4.9), (4.10).
// Niakh (2022): Theorem 1.3.1, Theorem 1.3.2.
#pragma once

#include "rbvi/core/contact_recipe.hpp"
#include "rbvi/core/dense.hpp"
#include "rbvi/core/formula.hpp"
#include "rbvi/core/terms.hpp"
#include "rbvi/core/units.hpp"

#include <vector>

namespace rbvi {

/// A plane of mirror symmetry that cuts the domain out of the body: component `component` of a
/// point is `position`, in the reference and in the mapped domain; the
/// domain is on one side.
struct MirrorPlane {
  int component = 0;
  double position = 0;
};

/// Every number that goes in or comes out is of the whole body, the domain with its images.
using MirrorPlanes = std::vector<MirrorPlane>;

/// Of the domain, itself among them.
int image_count(const MirrorPlanes &planes);
/// The images of each point of a part of the mesh: one on a plane is its own image there.
Vector image_counts(const MirrorPlanes &planes, const std::vector<Point> &points);
/// Whether the sum of a vector and its images has no such component.
bool cancels(const MirrorPlanes &planes, std::size_t component);
/// Whether the image of this number of a line, with the fields at its ends, is another line than
/// those of lower numbers: not where it lies on a plane.
bool has_image(const MirrorPlanes &planes, int image, const OutputFields &begin,
               const OutputFields &end);
/// Fields at a point become those at its image of this number, 0: itself.
void reflect(const MirrorPlanes &planes, int image, OutputFields &fields);

/// Options of a scene as text, resolved (defaults filled in): "load" -> "-25".
using SceneOptions = std::map<std::string, std::string>;

struct SceneOption {
  std::string name;
  std::string default_value; ///< of a number may be "": none is set
  std::string help;
  std::vector<std::string> choices; ///< empty: a number
  Range valid{};                    ///< of a number
  bool built_in_mesh = false;       ///< without meaning for a mesh from a file
  bool may_vary = false;            ///< "10,20" makes it a parameter with these bounds
  std::string unit{};               ///< of a number without one; "": that of the case
};

/// What a part of the mesh must be for the mesh to be the scene's, whoever made it.
struct MeshFact {
  std::string part; ///< a region or a boundary of the recipe; "": the whole mesh
  std::string is;   ///< completes "the part is ...": "the circle of radius 1 about the origin"
  /// How far a point is from the part, >= 0; of the mesh and of a region the negative depth inside.
  std::function<double(const Point &)> distance{};
  /// Length, area or volume; polygons with their vertices on a circle lack up to a tenth. 0: any.
  double size = 0;
  std::string within = ""; ///< a boundary that holds all facets of this one
  double excess = 1e-5;    ///< share by which the size may be larger, as about polygons in a body
};

/// A region of a material of its own: a disc, or the part of one between lines through its centre.
struct Inclusion {
  std::string region; ///< "": there is none
  Point centre{};
  double radius = 0;
};

/// Names the built-in mesh generator; `region` and `boundary` are the labels it sets.
struct MeshRecipe {
  std::string generator; ///< "square_with_disc", "two_quarter_discs", "two_blocks", "half_disc"...
  std::vector<std::string> regions;
  std::vector<std::string> boundaries;
  /// Edges of the contact boundary where the generator lets them be chosen; 0: its default.
  int edges = 0;
  std::vector<MeshFact> facts{}; ///< what a mesh must be beside the names above
  /// Refined vertices of its rim are brought back onto the circle; in the end the polygon is given
  /// the area of the disc.
  Inclusion inclusion{};
};

/// A displacement imposed on a boundary, theta(mu) value(x) or value(mu, x), x in the reference
/// domain; of the components that the boundary fixes. As with the terms of operators, theta makes
/// it exact: value must not depend on mu, which is empty there.
struct ImposedTerm {
  std::function<PointMap> value;
  std::optional<std::vector<Factor>> theta = {}; ///< the product of these; unset: value has mu
  /// Without theta: the parameters (as in Factor) that value depends on; unset: all.
  std::optional<std::vector<int>> parameters = {};
};

/// A boundary on which some components of the displacement are imposed: the sum of `values`, zero
/// without any, beside Scene::motion. Where two boundaries meet their values must agree.
struct FixedBoundary {
  std::string name;
  std::vector<int> components; ///< empty: all
  std::vector<ImposedTerm> values = {};
};

/// A boundary that moves as one along an axis: its nodes have one unknown displacement there. What
/// moves it is a load on the mean.
struct TiedBoundary {
  std::string name;
  int component;
};

/// A coordinate of a parameter in which the solutions vary smoothly: x = of(value), increasing or
/// decreasing, value = back(x).
struct Coordinate {
  std::function<NumberMap> of, back;
};

/// A material of an elastic body: Lame's constants at the centre of a reference cell, constant on
/// the cell; in 2D of plane strain, or of a body that is turned.
struct BodyMaterial {
  std::vector<std::string> regions; ///< of this material; none: the whole mesh
  std::function<Material> of_cell;
  /// At a point of the reference domain, the same in all directions: the strain that has no stress,
  /// such as a thermal one. Empty: none.
  std::function<PointValue> free_strain{};
};

/// An output of the scene's own (contact/named_outputs.hpp).
struct OutputForm {
  enum class Kind {
    integral,
    mean, ///< at a point the value there
    max,
    min,
    measure,
    reaction, ///< a(u, l) - f(l), l a unit displacement of fixed boundaries, zero at other nodes
    spring,   ///< stiffness m(u) + preload, m the sum of some means
    moment    ///< of the forces of contact on the (first) body
  };
  enum class Place { contact, boundary, region, point };
  std::string name, unit{}, says{}; ///< unit: "" where it is not known
  Kind kind = Kind::integral;
  Place place = Place::contact;
  std::vector<std::string> at{}; ///< contacts, boundaries or regions; no region: the whole mesh
  std::function<FieldValues> values{}; ///< what is integrated, ..., and where
  bool conditional = false;            ///< it is not asked for everywhere
  /// Parameters by which an extreme value and its condition move over the cells, as indices into
  /// parameters.all.
  std::vector<int> moved_by{};
  Point vector{}; ///< the point, or the direction of a reaction or of the axis of a moment
  std::vector<Mean> means{};                         ///< of a spring
  std::function<Coefficient> stiffness{}, preload{}; ///< of a spring; empty: 0
  std::vector<std::function<Coefficient>> about{};   ///< a point on the axis of a moment
  bool of_friction = false; ///< a moment: of the tangential tractions alone
};

/// Outputs of one full solve that are known.
struct SceneTest {
  std::string name;
  std::map<std::string, double> at{};       ///< parameters; the others keep their values
  std::map<std::string, double> expected{}; ///< outputs (core/outputs.hpp)
  double tolerance = 0;                     ///< relative; of an output that is 0 absolute
};

/// The nodes at x = 0, in the meshes of axisymmetric scenes.
constexpr const char *axis_of_turning = "x = 0";

struct Scene {
  std::string name;
  std::string summary; ///< one line
  /// What samples and models keep of it: the resolved case, a line "path: value" for each value
  /// (scene/stored_scene.hpp); of a program the name and version of its entry. Empty: the scene has
  /// no name, and models of it are not read again. Who changes a scene of a case in code clears it.
  std::string tree{};
  int dim = 2;
  int components = 1; ///< of the displacement
  int degree = 1;     ///< of the displacement on each cell: 1 or 2
  /// Of a body that is turned about x = 0: x >= 0 is the radius, and every integral is over the
  /// whole circumference. Nodes at x = 0 are the boundary `axis_of_turning`, which `fixed` holds.
  bool axisymmetric = false;
  SceneOptions options;
  std::optional<UnitSystem> units; ///< of numbers with a unit that a run gives
  ParameterSpace parameters;
  std::map<int, Coordinate> coordinates; ///< of some of parameters.all; the others: themselves
  /// Throws bad_input where values of all parameters that are valid one by one make no sense
  /// together; empty: they always do.
  std::function<Check> check_parameters;
  std::string training = "", validation = ""; ///< default sets, as parse_set reads them
  MeshRecipe mesh;

  /// h(mu), from the reference to the mapped domain.
  std::function<PointMap> map;
  /// The exact curve of a boundary, or of the rim of a region, by its name: brings a point beside
  /// it onto it. Refined vertices and middles of edges are those of the curve of their own
  /// boundary.
  std::map<std::string, std::function<Point(const Point &)>> curves{};

  std::vector<FixedBoundary> fixed;
  std::vector<TiedBoundary> tied = {};
  /// Rigid motion of each body at a point of the reference domain, which the displacement is
  /// measured from: u = motion + w, w = 0 (or FixedBoundary::values) where it is fixed. Costs
  /// nothing, unlike other Dirichlet data; empty: zero.
  std::function<PointMap> motion;
  /// The data are symmetric about x = 0, and so are the solutions on a mesh that is, where the
  /// parameter `skewed_by`, if there is one, is fixed at zero; see is_symmetric.
  bool symmetric = false;
  int skewed_by = -1;
  /// Small kinematics are meant, however far bodies move: nothing warns of them.
  bool small = false;
  MirrorPlanes mirrors{}; ///< what a and f have are the domain's, all outputs the whole body's

  /// Where the body can touch: at least one.
  std::vector<ContactRecipe> contacts;

  /// Each cell of the mesh has one. Empty: not elastic (a membrane), then there are no stresses.
  std::vector<BodyMaterial> materials;

  Sum a;         ///< symmetric
  Sum f;         ///< empty: no load
  Sum v_product; ///< inner product of V, exact terms; mu is empty there
  /// 0: v_product becomes h1_product_of the size of the body, which the mesh says.
  double v_length = 1;

  std::vector<OutputForm> outputs{};
  std::vector<SceneTest> tests{};
};

/// An option of the program that a case file sets.
struct CaseSetting {
  std::string name, value;
  int line = 0;
};

struct SceneEntry {
  std::string name, summary{};
  std::vector<SceneOption> options{};
  std::function<Scene(const SceneOptions &)> make{};
  int version = 1; ///< of a program's scene, raised with its answers: models keep it; 0: a case
  std::vector<CaseSetting> settings{};
  std::vector<std::pair<std::string, std::string>> variants{}; ///< of its file, with what they are
  std::map<std::string, double> mesh_numbers{};                ///< of the .geo that its mesh is
  int mesh_dim = 2;                                            ///< likewise
  std::optional<UnitSystem> units{};                           ///< of numbers with a unit
};

/// The scenes that a program knows by name.
using Registry = std::vector<SceneEntry>;

/// Whether some interface has friction.
bool has_friction(const Scene &scene);
/// Whether multipliers hold contact in all of them, B u <= g: there are laws, cones, supremizers.
/// Otherwise Nitsche's method does.
bool has_multipliers(const Scene &scene);
bool separable_contact(const Scene &scene);
/// Whether G is a sum of few terms beside B. On surfaces it takes many, and is assembled for each
/// mu.
bool separable_gap(const Scene &scene);
/// Whether some interface follows the state.
bool follows_state(const Scene &scene);
bool keeps_nodes(const Scene &scene);
/// Whether every interface bounds single nodes, without friction.
bool bounds_nodes(const Scene &scene);

/// What a contact of the scene is called: its name; without one "contact", of several "contact 1",
/// "contact 2", ...
std::string contact_name(const Scene &scene, std::size_t number);

/// Whether data and solutions are symmetric about x = 0 for all free parameters.
bool is_symmetric(const Scene &scene);

/// The coordinate of a parameter; null: the parameter itself.
const Coordinate *coordinate_of(const Scene &scene, int parameter);

/// Whether a is the same for all values of the free parameters.
bool constant_stiffness(const Scene &scene);
/// Whether A varies, by a common coefficient of its terms alone: factors, and displacements under
/// unit loads, then serve all mu.
bool stiffness_scales(const Scene &scene);

/// Throws bad_input for an unknown scene, naming those that exist.
const SceneEntry &entry_of(const Registry &registry, const std::string &scene);

/// Makes a scene; options that are left out take their default. Throws bad_input for an unknown
/// option or a value that is not allowed.
Scene make_scene(const SceneEntry &entry, const SceneOptions &options = {});

} // namespace rbvi
