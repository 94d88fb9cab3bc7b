"""Pictures of checked trees: wires, boxes, Graphviz, Mermaid, SVG, and the difference of two."""
