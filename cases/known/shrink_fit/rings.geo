// Sections of two rings, of radii 1 to 2 and 2 to 3, which meet without common nodes.
DefineConstant[edges = 8]; // of the width and of the height of each
For i In {0:1}
  p = 10 * i;
  Point(p + 1) = {1 + i, 0, 0};
  Point(p + 2) = {2 + i, 0, 0};
  Point(p + 3) = {2 + i, 0.5, 0};
  Point(p + 4) = {1 + i, 0.5, 0};
  Line(p + 1) = {p + 1, p + 2};
  Line(p + 2) = {p + 2, p + 3};
  Line(p + 3) = {p + 3, p + 4};
  Line(p + 4) = {p + 4, p + 1};
  Transfinite Curve {p + 1, p + 3} = edges * (i + 1) + 1;
  Transfinite Curve {p + 2, p + 4} = edges + 1 - 3 * i;
  Curve Loop(i + 1) = {p + 1, p + 2, p + 3, p + 4};
  Plane Surface(i + 1) = {i + 1};
  Transfinite Surface {i + 1};
EndFor
Physical Curve("foot") = {1, 11};
Physical Curve("seat") = {2};
Physical Curve("bore") = {14};
Physical Surface("inner") = {1};
Physical Surface("outer") = {2};
