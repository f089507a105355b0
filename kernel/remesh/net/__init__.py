"""From the lines of a map to a net of nodes, edges and cells.

crossings   Where the lines of a seamless map cross the edges of the triangles, and each
            other.
extraction  The net of a seamless map: lines become edges, their crossings nodes, the cells
            between faces.
net_mesh    From the cells of a net to a mesh without slivers along its boundary.
"""
