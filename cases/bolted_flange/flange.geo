// Half a bolted pipe joint, DN 200, by its plane of symmetry z = 0, in the plane (r, z): a welding
// neck flange and a gasket. The two bodies have no common node, though the top of the gasket lies
// on the face: no Coherence.
If (!Exists(edges))
  edges = 60; // on the top of the gasket
EndIf
h = 30 / edges;
coarse = 8 * h;
fine = h / 4; // where stresses are singular: the corner of hub and plate, the rim that meets the stop

Point(1) = {101.5, 2, 0, coarse};
Point(2) = {112, 2, 0, h};
Point(3) = {142, 2, 0, h};
Point(4) = {172, 2, 0, coarse};
Point(5) = {187.5, 2, 0, fine};
Point(6) = {187.5, 36, 0, coarse};
Point(7) = {175, 36, 0, coarse};
Point(8) = {145, 36, 0, coarse};
Point(9) = {122, 36, 0, fine};
Point(10) = {109.5, 90, 0, coarse};
Point(11) = {109.5, 202, 0, coarse};
Point(12) = {101.5, 202, 0, coarse};
For i In {1:11}
  Line(i) = {i, i + 1};
EndFor
Line(12) = {12, 1};
Curve Loop(1) = {1:12};
Plane Surface(1) = {1};

Point(21) = {112, 0, 0, h};
Point(22) = {142, 0, 0, h};
Point(23) = {142, 2, 0, h};
Point(24) = {112, 2, 0, h};
Line(21) = {21, 22};
Line(22) = {22, 23};
Line(23) = {23, 24};
Line(24) = {24, 21};
Curve Loop(2) = {21:24};
Plane Surface(2) = {2};
Transfinite Curve {21, 23} = edges + 1 Using Bump 0.5; // friction is singular at both ends
Transfinite Curve {2} = edges + 1 Using Bump 0.5;

Physical Surface("flange") = {1};
Physical Surface("gasket") = {2};
Physical Curve("face_inside") = {1};
Physical Curve("face") = {2, 3};
Physical Curve("face_outside") = {4};
Physical Curve("bolts") = {7};
Physical Curve("pipe_end") = {11};
Physical Curve("bore") = {12};
Physical Curve("middle") = {21};
Physical Curve("gasket_top") = {23};
Physical Curve("gasket_inside") = {24};
