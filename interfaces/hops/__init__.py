"""The server of Grasshopper's Hops component: nodes and saved graphs as components.

The protocol is that of Hops 0.16 and later: `GET /` lists components, `GET /NAME` describes
one, `POST /solve` runs it. Values go as text in JSON; what is too large, or nothing that
Grasshopper knows, goes as a handle: a text that components after it take back.

application    Requests and answers: the routes, and errors as JSON.
catalogue      Which components there are: nodes, and the graphs of a folder.
client         A client for Rhino's own Python; the standard library alone.
components     Inputs and outputs of a component, made of the ports of a node.
description    A component in JSON, as Grasshopper asks for it.
guard          Who may ask, and which files may be named.
handles        Texts that stand for values.
jobs           Long runs: joined by retries, four at once.
page           The list of components for the browser.
parameters     Which parameters of Grasshopper carry the values of a port.
server         The server around the application.
solving        One request: its branches and items, and the runs that they ask for.
trees          Data trees in JSON: paths and items.
values_in      Values that Grasshopper sends, as those of ports.
values_out     Values of ports, as Grasshopper takes them.
"""
