// A ring of rubber in its groove: a disk whose boundary is cut at the angles where its sides begin.
R = 2.665;
If (!Exists(edges))
  edges = 100;
EndIf
h = 2 * Pi * R / edges;
Point(1) = {R, R, 0, h};
angles[] = {-140, -40, 40, 140};
For i In {0:3}
  Point(2 + i) = {R + R * Cos(angles[i] * Pi / 180), R + R * Sin(angles[i] * Pi / 180), 0, h};
EndFor
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Circle(4) = {5, 1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("wall") = {4};
Physical Surface("rubber") = {1};
