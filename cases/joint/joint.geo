// Two flanges, each with its web: rectangles with the same regular mesh, so that the lower body is
// the mirror image of the upper one. Their faces lie on y = 0 without a common node: no Coherence.
If (!Exists(edges))
  edges = 60; // on a face
EndIf
e = edges / 60;
x[] = {-45, -36, -24, -6, 6, 24, 36, 45};
n[] = {6, 8, 12, 8, 12, 8, 6};

For side In {0:1}
  s = 1 - 2 * side;
  p = 100 * (side + 1);
  For i In {0:7}
    Point(p + i) = {x[i], 0, 0};
    Point(p + 10 + i) = {x[i], 20 * s, 0};
    Line(p + 20 + i) = {p + i, p + 10 + i};
  EndFor
  Transfinite Curve {p + 20 : p + 27} = Round(10 * e) + 1;
  For i In {0:6}
    Line(p + i) = {p + i, p + i + 1};
    Line(p + 10 + i) = {p + 10 + i, p + 11 + i};
    Transfinite Curve {p + i, p + 10 + i} = Round(n[i] * e) + 1;
    Curve Loop(p + i) = {p + i, p + 21 + i, -(p + 10 + i), -(p + 20 + i)};
    Plane Surface(p + i) = {p + i};
    Transfinite Surface {p + i};
  EndFor
  Point(p + 33) = {-6, 60 * s, 0};
  Point(p + 34) = {6, 60 * s, 0};
  Line(p + 33) = {p + 13, p + 33};
  Line(p + 34) = {p + 14, p + 34};
  Line(p + 35) = {p + 33, p + 34};
  Transfinite Curve {p + 33, p + 34} = Round(20 * e) + 1;
  Transfinite Curve {p + 35} = Round(8 * e) + 1;
  Curve Loop(p + 30) = {p + 13, p + 34, -(p + 35), -(p + 33)};
  Plane Surface(p + 30) = {p + 30};
  Transfinite Surface {p + 30};
EndFor

Physical Surface("upper") = {100:106, 130};
Physical Surface("lower") = {200:206, 230};
Physical Curve("face") = {100:106};
Physical Curve("lower_face") = {200:206};
Physical Curve("side") = {120};
Physical Curve("head_left") = {111};
Physical Curve("head_right") = {115};
Physical Curve("nut_left") = {211};
Physical Curve("nut_right") = {215};
Physical Curve("web") = {135};
Physical Curve("base") = {235};
