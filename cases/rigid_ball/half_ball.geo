// The lower half of a ball of radius 1 about the origin, with a core of radius 0.6. Boundaries: top
// (the flat side z = 0), cap (within pi / 7 of the pole), arc (all of the sphere).
SetFactory("OpenCASCADE");
DefineConstant[ size = 1 ]; // of all cells: 1 some 12 000, 0.5 some 100 000 dofs of degree 2
angle = Pi / 7;

Sphere(1) = {0, 0, 0, 1, -Pi / 2, -Pi / 2 + angle, 2 * Pi};
Sphere(2) = {0, 0, 0, 1, -Pi / 2 + angle, 0, 2 * Pi};
Sphere(3) = {0, 0, 0, 0.6, -Pi / 2, 0, 2 * Pi};
BooleanFragments{ Volume{1, 2}; Delete; }{ Volume{3}; Delete; }

eps = 1e-6;
core() = Volume In BoundingBox{-0.6 - eps, -0.6 - eps, -0.6 - eps, 0.6 + eps, 0.6 + eps, eps};
Physical Volume("core") = core();
rest() = Volume{:};
rest() -= core();
Physical Volume("shell") = rest();

top() = Surface In BoundingBox{-1 - eps, -1 - eps, -eps, 1 + eps, 1 + eps, eps};
Physical Surface("top") = top();
r = Sin(angle);
below() = Surface In BoundingBox{-r - eps, -r - eps, -1 - eps, r + eps, r + eps, -Cos(angle) + eps};
outer() = CombinedBoundary{ Volume{:}; };
arc() = {};
cap() = {};
For i In {0 : #outer() - 1}
  s = Abs(outer(i));
  is_top = 0;
  For k In {0 : #top() - 1}
    If (top(k) == s)
      is_top = 1;
    EndIf
  EndFor
  If (!is_top)
    arc() += s;
    For k In {0 : #below() - 1}
      If (below(k) == s)
        cap() += s;
      EndIf
    EndFor
  EndIf
EndFor
Physical Surface("cap") = cap();
Physical Surface("arc") = arc();

// One size for the contact, growing with the distance from the pole.
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
Field[1] = MathEval;
Field[1].F = Sprintf("%g * Max(0.03, Min(0.3, 0.03 + 0.28 * (Sqrt(x*x + y*y + (z + 1)*(z + 1)) - 0.22)))", size);
Background Field = 1;
Mesh.Algorithm3D = 1;
Mesh.Optimize = 1;
