// A bracket: a plate with a hole, clamped on the left, and a pad glued under its free end. The ring
// about the hole, up to the radius that the map of the case leaves alone, has vertices of its own.
If (!Exists(edges))
  edges = 40; // on the foot of the pad
EndIf
h = 30 / edges;
coarse = 5 * h;
hole = 7;
ring = 13;
cx = 45;
cy = 23;

Point(1) = {0, 8, 0, 2 * h};
Point(2) = {90, 8, 0, h};
Point(3) = {120, 8, 0, h};
Point(4) = {120, 38, 0, coarse};
Point(5) = {60, 38, 0, coarse};
Point(6) = {0, 38, 0, 2 * h};
Point(7) = {90, 0, 0, h};
Point(8) = {120, 0, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Line(7) = {2, 7};
Line(8) = {7, 8};
Line(9) = {8, 3};
Transfinite Curve {2, 8} = edges + 1;

Point(20) = {cx, cy, 0};
For i In {0:3}
  a = i * Pi / 2;
  Point(21 + i) = {cx + hole * Cos(a), cy + hole * Sin(a), 0, 2 * h};
  Point(25 + i) = {cx + ring * Cos(a), cy + ring * Sin(a), 0, 3 * h};
EndFor
For i In {0:3}
  Circle(21 + i) = {21 + i, 20, 21 + (i + 1) % 4};
  Circle(25 + i) = {25 + i, 20, 25 + (i + 1) % 4};
EndFor
Curve Loop(1) = {1:6};
Curve Loop(2) = {-2, 7, 8, 9};
Curve Loop(3) = {21:24};
Curve Loop(4) = {25:28};
Plane Surface(1) = {1, 4};
Plane Surface(2) = {2};
Plane Surface(3) = {4, 3};

Physical Surface("plate") = {1, 3};
Physical Surface("pad") = {2};
Physical Curve("clamp") = {6};
Physical Curve("loaded") = {4};
Physical Curve("hole") = {21:24};
Physical Curve("foot") = {8};
